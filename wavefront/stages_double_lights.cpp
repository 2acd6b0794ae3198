#include "wavefront/compiled_stages.h"

namespace raypool::wavefront {

template StagesMaker<record_features(kEverything), double>
stages_maker<kEverything, WideReal<double>, NoTestCount, Splitting::Off>();

}  // namespace raypool::wavefront
