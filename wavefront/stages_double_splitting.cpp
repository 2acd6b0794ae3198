#include "wavefront/compiled_stages.h"

namespace raypool::wavefront {

template StagesMaker<record_features(kEverything), double>
stages_maker<kEverything, WideReal<double>, ListCount, Splitting::On>();

}  // namespace raypool::wavefront
