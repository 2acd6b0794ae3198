#include "wavefront/compiled_stages.h"

namespace raypool::wavefront {

#ifndef RAYPOOL_ONE_FEATURE_SET
template StagesMaker<record_features(kCompiledFeatures[0]), float>
stages_maker<kCompiledFeatures[0], float, NoTestCount, Splitting::Off>();
template StagesMaker<record_features(kCompiledFeatures[1]), float>
stages_maker<kCompiledFeatures[1], float, NoTestCount, Splitting::Off>();
template StagesMaker<record_features(kAllButLights), float>
stages_maker<kAllButLights, float, NoTestCount, Splitting::Off>();
#endif
template StagesMaker<record_features(kEverything), float>
stages_maker<kEverything, float, NoTestCount, Splitting::Off>();
template StagesMaker<record_features(kEverything), float> stages_maker<kEverything, float, ListCount, Splitting::On>();

}  // namespace raypool::wavefront
