/// The render function in each precision, one ray or one register of rays at a time. A file each: they compile slowly.
#pragma once

#include "core/engine.h"
#include "wavefront/settings.h"

namespace raypool::wavefront {

RenderReport render_scalar(const CompiledScene<float>&, const RenderSettings&, const PoolSettings&, Framebuffer&);
RenderReport render_scalar(const CompiledScene<double>&, const RenderSettings&, const PoolSettings&, Framebuffer&);
RenderReport render_simd(const CompiledScene<float>&, const RenderSettings&, const PoolSettings&, Framebuffer&);
RenderReport render_simd(const CompiledScene<double>&, const RenderSettings&, const PoolSettings&, Framebuffer&);

}  // namespace raypool::wavefront
