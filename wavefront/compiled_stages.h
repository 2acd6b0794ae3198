/// The definition of stages_maker(): included by nothing but the files that instantiate it.
#pragma once

#include "wavefront/render.h"
#include "wavefront/stages.h"

namespace raypool::wavefront {

template <Features features, class Real, class Work, Splitting splitting>
StagesMaker<record_features(features), ScalarOf<Real>> stages_maker() {
    using Compiled = Stages<features, Real, Work, splitting>;
    using Scalar = ScalarOf<Real>;
    return {[](const RenderContext<Scalar>& context, std::size_t most_records,
               int thread) -> std::unique_ptr<RecordStages<record_features(features), Scalar>> {
                return std::make_unique<Compiled>(context, most_records, thread);
            },
            &Compiled::bytes};
}

}  // namespace raypool::wavefront
