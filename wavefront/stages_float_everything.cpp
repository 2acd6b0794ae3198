#include "wavefront/compiled_stages.h"

namespace raypool::wavefront {

template StagesMaker<record_features(kAllButLights), float>
stages_maker<kAllButLights, WideReal<float>, NoTestCount, Splitting::Off>();

}  // namespace raypool::wavefront
