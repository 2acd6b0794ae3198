#include "bench/stability/case.h"
#include "core/base/error.h"

namespace raypool::stability {

const Method& Case::method(const std::string& name) const {
    for (const Method& method : methods)
        if (method.name == name) return method;
    RAYPOOL_CHECK(false, "a case of stability has the method that is asked for");
    return methods.front();
}

const std::vector<Case>& all_cases() {
    static const std::vector<Case> kCases = [] {
        std::vector<Case> all;
        for (const auto& family : {sphere_cases(), leaving_cases(), coincidence_cases(), box_cases(), motion_cases(),
                                   scattering_cases(), glass_cases(), path_cases(), sum_cases(), random_cases(),
                                   texture_cases(), size_cases(), flat_cases(), image_cases()})
            all.insert(all.end(), family.begin(), family.end());
        return all;
    }();
    return kCases;
}

const Case& find_case(const std::string& id) {
    for (const Case& one : all_cases())
        if (one.id == id) return one;
    RAYPOOL_CHECK(false, "there is a case of stability with the id that is asked for");
    return all_cases().front();
}

}  // namespace raypool::stability
