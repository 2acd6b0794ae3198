#include "wavefront/compiled_stages.h"

namespace raypool::wavefront {

template StagesMaker<record_needs(kCompiledNeeds[1]), double>
stages_maker<kCompiledNeeds[1], double, NoWorkCount, Splitting::Off>();
template StagesMaker<record_needs(kEverything), double>
stages_maker<kEverything, double, NoWorkCount, Splitting::Off>();
template StagesMaker<record_needs(kEverything), double> stages_maker<kEverything, double, ListCount, Splitting::On>();

}  // namespace raypool::wavefront
