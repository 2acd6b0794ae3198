/// Sessions in each precision, one ray or one register of rays at a time. A file each: they compile slowly.
#pragma once

#include "core/engine.h"
#include "wavefront/settings.h"

namespace raypool::wavefront {

std::unique_ptr<RenderSession> begin_scalar(const CompiledScene<float>&, const RenderSettings&, const PoolSettings&,
                                            Framebuffer&);
std::unique_ptr<RenderSession> begin_scalar(const CompiledScene<double>&, const RenderSettings&, const PoolSettings&,
                                            Framebuffer&);
std::unique_ptr<RenderSession> begin_simd(const CompiledScene<float>&, const RenderSettings&, const PoolSettings&,
                                          Framebuffer&);
std::unique_ptr<RenderSession> begin_simd(const CompiledScene<double>&, const RenderSettings&, const PoolSettings&,
                                          Framebuffer&);

}  // namespace raypool::wavefront
