#include <algorithm>
#include <map>

#include <nlohmann/json.hpp>

#include "bench/stability/case.h"
#include "bench/stability/cases_json.h"
#include "core/base/error.h"

namespace raypool::stability {

namespace {

std::map<std::string, std::vector<Method>> all_methods() {
    std::map<std::string, std::vector<Method>> all;
    for (const auto& family :
         {sphere_cases(), leaving_cases(), coincidence_cases(), box_cases(), motion_cases(), scattering_cases(),
          glass_cases(), path_cases(), sum_cases(), random_cases(), texture_cases(), size_cases(), planar_cases(),
          light_cases(), environment_cases(), environment_direction_cases(), mesh_cases(), image_cases()})
        for (const auto& one : family) {
            const bool is_first = all.insert(one).second;
            RAYPOOL_CHECK(is_first, "a case of stability has one list of methods");
        }
    return all;
}

/// What has the name; that there is nothing is a bug.
template <class T>
const T& find(const std::vector<T>& all, std::string T::*name, const std::string& wanted) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const T& one) { return one.*name == wanted; });
    RAYPOOL_CHECK(found != all.end(), "a case or a method of stability has the name that is asked for");
    return *found;
}

}  // namespace

const Method& Case::method(const std::string& name) const {
    return find(methods, &Method::name, name);
}

const std::vector<Case>& all_cases() {
    static const std::vector<Case> kCases = [] {
        const std::map<std::string, std::vector<Method>> methods = all_methods();
        std::vector<Case> all;
        for (const nlohmann::json& entry : nlohmann::json::parse(kCasesJson)) {
            const auto values = entry.at("values").get<std::vector<double>>();
            all.push_back({entry.at("id"), entry.at("row"), entry.at("parameter"), values, entry.at("measure"),
                           entry.at("tolerance"), entry.at("samples"), entry.at("symptom"),
                           entry.value("held", values.size()), entry.value("limit", ""),
                           methods.at(entry.at("id").get<std::string>())});
        }
        RAYPOOL_CHECK(all.size() == methods.size(), "cases.json has an entry for every case");
        return all;
    }();
    return kCases;
}

const Case& find_case(const std::string& id) {
    return find(all_cases(), &Case::id, id);
}

}  // namespace raypool::stability
