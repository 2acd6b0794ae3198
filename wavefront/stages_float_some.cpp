#include "wavefront/compiled_stages.h"

namespace raypool::wavefront {

template StagesMaker<record_needs(kCompiledNeeds[0]), float>
stages_maker<kCompiledNeeds[0], WideReal<float>, NoWorkCount, Splitting::Off>();
template StagesMaker<record_needs(kCompiledNeeds[1]), float>
stages_maker<kCompiledNeeds[1], WideReal<float>, NoWorkCount, Splitting::Off>();

}  // namespace raypool::wavefront
