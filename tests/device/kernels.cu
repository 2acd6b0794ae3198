// The kernels of core/ as a GPU would call them: what nvcc must be able to compile. Nothing runs it.

#include "core/shading/camera.h"
#include "core/shading/shade.h"

using namespace raypool;

__global__ void trace_segment(SceneView<float> scene, RandomSeed seed, const float* sphere, std::int32_t id, float* out) {
    const PathKey<float> key{17U, 5U};
    const Ray<float> ray = camera_ray<kEverything, float>(scene.camera, 3.0F, 4.0F, key.pixel, key.sample, seed);
    const float t = sphere_distance<float>(ray.origin, ray.direction, vec3<float>(sphere[0], sphere[1], sphere[2]),
                                           sphere[3], false);
    const Scattered<float> next = scatter<kEverything, float>(scene, ray, t, id, vec3<float>(1.0F, 1.0F, 1.0F), key, 1U,
                                                              seed, 0, true);
    const Vec3<float> sky = escaping_radiance<kEverything, float>(scene, next.direction, next.throughput,
                                                                  LightSampling::Mis, 1.0F);
    for (int k = 0; k < 3; ++k) out[k] = sky[k] + next.start.origin[k];
}
