#include "wavefront/compiled_stages.h"

namespace raypool::wavefront {

template StagesMaker<record_features(kCompiledFeatures[0]), float>
stages_maker<kCompiledFeatures[0], WideReal<float>, NoTestCount, Splitting::Off>();
template StagesMaker<record_features(kCompiledFeatures[1]), float>
stages_maker<kCompiledFeatures[1], WideReal<float>, NoTestCount, Splitting::Off>();

}  // namespace raypool::wavefront
