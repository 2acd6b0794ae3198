#include "core/runtime/registry.h"

#include <algorithm>

#include "core/base/error.h"

namespace raypool {

void EngineRegistry::add(EngineEntry entry) {
    const auto has_name = [&](const EngineEntry& other) { return other.name == entry.name; };
    RAYPOOL_CHECK(std::none_of(entries_.begin(), entries_.end(), has_name), "two engines have one name");
    entries_.push_back(std::move(entry));
}

std::vector<std::string> EngineRegistry::names() const {
    std::vector<std::string> names;
    for (const EngineEntry& entry : entries_) names.push_back(entry.name);
    return names;
}

const EngineEntry& EngineRegistry::find(const std::string& name) const {
    const auto found =
        std::find_if(entries_.begin(), entries_.end(), [&](const auto& entry) { return entry.name == name; });
    RAYPOOL_CHECK(found != entries_.end(), "an engine was asked for that is none");
    return *found;
}

const EngineEntry& EngineRegistry::preferred(bool must_keep_costs) const {
    const auto can = [&](const EngineEntry& entry) { return entry.keeps_costs || !must_keep_costs; };
    const auto found = std::find_if(entries_.begin(), entries_.end(), can);
    RAYPOOL_CHECK(found != entries_.end(), "no engine can do what was asked");
    return *found;
}

}  // namespace raypool
