#include "wavefront/compiled_stages.h"

namespace raypool::wavefront {

template StagesMaker<record_needs(kCompiledNeeds[1]), double>
stages_maker<kCompiledNeeds[1], WideReal<double>, NoWorkCount, Splitting::Off>();

}  // namespace raypool::wavefront
