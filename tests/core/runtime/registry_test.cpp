#include "core/runtime/registry.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/image/cost_image.h"
#include "recursive/engine.h"
#include "tests/small_render.h"
#include "wavefront/engine.h"

namespace raypool::test {
namespace {

EngineRegistry all_engines() {
    EngineRegistry registry;
    wavefront::add_engines(registry);
    recursive::add_engines(registry);
    return registry;
}

TEST(EngineRegistry, MakesEnginesOfTheNamesThatItListsWhichMakeOneImage) {
    const EngineRegistry registry = all_engines();
    EXPECT_EQ(registry.names(), (std::vector<std::string>{"wavefront", "recursive", "iterative"}));
    const CompiledScene<float> scene = compile<float>(small_scene("cornell", 16));
    RenderSettings settings;
    settings.end_sample = 4;
    const std::string expected = render(*registry.find("recursive").make({}), scene, settings).hash();
    for (const EngineEntry& entry : registry.entries()) {
        const std::unique_ptr<Engine> engine = entry.make({});
        EXPECT_EQ(engine->name(), entry.name);
        EXPECT_EQ(render(*engine, scene, settings).hash(), expected) << entry.name;
    }
}

TEST(EngineRegistry, SaysWhatEnginesCanDoAsTheyDo) {
    const CompiledScene<float> scene = compile<float>(small_scene("cornell", 16));
    const EngineRegistry registry = all_engines();
    for (const EngineEntry& entry : registry.entries()) {
        RenderSettings settings;
        settings.log_rounds = true;
        const RenderReport report = render(*entry.make({}), scene, settings).report;
        EXPECT_EQ(!wavefront::pool_report(report).rounds.empty(), entry.has_pool) << entry.name;

        CostImage cost(Cost::Segments, scene.width, scene.height);
        settings.cost_image = &cost;
        if (entry.keeps_costs) {
            render(*entry.make({}), scene, settings);
        } else {
            EXPECT_THROW(render(*entry.make({}), scene, settings), InputError) << entry.name;
        }
    }
}

TEST(EngineRegistry, PrefersTheFirstThatCanDoWhatIsAsked) {
    const EngineRegistry registry = all_engines();
    EXPECT_EQ(registry.preferred(false).name, "wavefront");
    EXPECT_EQ(registry.preferred(true).name, "recursive");
}

TEST(EngineRegistry, HandsOptionsToTheEngineThatTheyAreFor) {
    wavefront::PoolSettings pool;
    pool.capacity = 77;
    const CompiledScene<float> scene = compile<float>(small_scene("cornell", 16));
    const std::unique_ptr<Engine> engine = all_engines().find("wavefront").make(pool);
    EXPECT_EQ(wavefront::pool_report(render(*engine, scene, RenderSettings{}).report).pool_rays, 77U);
}

TEST(EngineRegistryDeathTest, TakesNoNameTwiceAndFindsNoneThatIsNot) {
    EngineRegistry registry = all_engines();
    EXPECT_DEATH(recursive::add_engines(registry), "two engines have one name");
    EXPECT_DEATH((void)registry.find("radiosity"), "none");
}

}  // namespace
}  // namespace raypool::test
