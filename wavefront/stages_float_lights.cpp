#include "wavefront/compiled_stages.h"

namespace raypool::wavefront {

template StagesMaker<record_features(kEverything), float>
stages_maker<kEverything, WideReal<float>, NoTestCount, Splitting::Off>();

}  // namespace raypool::wavefront
