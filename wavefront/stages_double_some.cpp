#include "wavefront/compiled_stages.h"

namespace raypool::wavefront {

template StagesMaker<record_features(kCompiledFeatures[1]), double>
stages_maker<kCompiledFeatures[1], WideReal<double>, NoTestCount, Splitting::Off>();

}  // namespace raypool::wavefront
