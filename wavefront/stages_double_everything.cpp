#include "wavefront/compiled_stages.h"

namespace raypool::wavefront {

template StagesMaker<record_features(kAllButLights), double>
stages_maker<kAllButLights, WideReal<double>, NoTestCount, Splitting::Off>();

}  // namespace raypool::wavefront
