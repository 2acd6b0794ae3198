#include "wavefront/compiled_stages.h"

namespace raypool::wavefront {

template StagesMaker<record_needs(kCompiledNeeds[0]), float>
stages_maker<kCompiledNeeds[0], float, NoWorkCount, Splitting::Off>();
template StagesMaker<record_needs(kCompiledNeeds[1]), float>
stages_maker<kCompiledNeeds[1], float, NoWorkCount, Splitting::Off>();
template StagesMaker<record_needs(kEverything), float> stages_maker<kEverything, float, NoWorkCount, Splitting::Off>();
template StagesMaker<record_needs(kEverything), float> stages_maker<kEverything, float, ListCount, Splitting::On>();

}  // namespace raypool::wavefront
