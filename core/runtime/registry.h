/// Engines by name, with what they can do.
///
/// The library of an engine adds it (`add_engines(registry)` in its namespace), and a program adds up the libraries
/// that it links. Code that offers a choice of engines, or asks what one can do, asks a registry: no second list
/// exists.
#pragma once

#include <any>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/runtime/engine.h"

namespace raypool {

struct EngineEntry {
    std::string name;
    std::string description;   ///< in a line, for listings
    bool keeps_costs = false;  ///< fills RenderSettings::cost_image
    bool has_pool = false;     ///< works on pools of ray records, and reports rounds
    /// Whether it can carry out the settings, on this machine: it has what the engine renders on.
    std::function<bool(const RenderSettings&)> can_render = [](const RenderSettings&) { return true; };
    /// `options` are of the engine's own type, or empty: its defaults.
    std::function<std::unique_ptr<Engine>(const std::any& options)> make;
};

class EngineRegistry {
  public:
    /// In order of preference: the first that can do what is asked is the default. A name that is taken is a bug.
    void add(EngineEntry entry);
    [[nodiscard]] const std::vector<EngineEntry>& entries() const { return entries_; }
    [[nodiscard]] std::vector<std::string> names() const;
    /// A name that is none is a bug.
    [[nodiscard]] const EngineEntry& find(const std::string& name) const;
    /// The engine to use where none is named.
    [[nodiscard]] const EngineEntry& preferred(bool must_keep_costs) const;

  private:
    std::vector<EngineEntry> entries_;
};

}  // namespace raypool
