#include "wavefront/compiled_stages.h"

namespace raypool::wavefront {

#ifndef RAYPOOL_ONE_FEATURE_SET
template StagesMaker<record_features(kCompiledFeatures[1]), double>
stages_maker<kCompiledFeatures[1], double, NoTestCount, Splitting::Off>();
template StagesMaker<record_features(kAllButLights), double>
stages_maker<kAllButLights, double, NoTestCount, Splitting::Off>();
#endif
template StagesMaker<record_features(kEverything), double>
stages_maker<kEverything, double, NoTestCount, Splitting::Off>();
template StagesMaker<record_features(kEverything), double>
stages_maker<kEverything, double, ListCount, Splitting::On>();

}  // namespace raypool::wavefront
