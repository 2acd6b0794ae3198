#include "core/image/exr_layer.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfPartType.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

namespace raypool {

namespace {

bool is_deep(const Imf::Header& header) {
    return header.hasType() && !Imf::isImage(header.type());
}

std::optional<ExrLayer> layer_of(const Imf::MultiPartInputFile& file, const std::array<const char*, 3>& names) {
    for (int part = 0; part < file.parts(); ++part) {
        if (is_deep(file.header(part))) continue;
        const Imf::ChannelList& channels = file.header(part).channels();
        const std::string_view first(names[0]);
        std::optional<ExrLayer> found;
        for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
            const std::string_view name(channel.name());
            if (!name.ends_with(first) || (name.size() > first.size() && name[name.size() - first.size() - 1] != '.'))
                continue;
            const std::string prefix(name.substr(0, name.size() - first.size()));
            const ExrLayer layer{part, {prefix + names[0], prefix + names[1], prefix + names[2]}, false};
            const bool is_whole = std::all_of(layer.channels.begin(), layer.channels.end(), [&](const auto& c) {
                return channels.findChannel(c.c_str()) != nullptr;
            });
            if (is_whole && (!found || prefix.empty())) found = layer;
        }
        if (found) return found;
    }
    return {};
}

}  // namespace

ExrLayer find_layer(const Imf::MultiPartInputFile& file) {
    if (const std::optional<ExrLayer> colour = layer_of(file, {"R", "G", "B"})) return *colour;
    std::optional<ExrLayer> grey = layer_of(file, {"Y", "Y", "Y"});
    if (!grey) throw std::runtime_error("has no channels R, G and B, and no luminance Y, in a part that is not deep");
    const Imf::ChannelList& channels = file.header(grey->part).channels();
    grey->has_chroma = file.parts() == 1 && grey->channels[0] == "Y" && channels.findChannel("RY") != nullptr &&
                       channels.findChannel("BY") != nullptr;
    return *grey;
}

std::vector<std::string> left_out(const Imf::MultiPartInputFile& file, const ExrLayer& layer) {
    std::vector<std::string> names;
    for (int part = 0; part < file.parts(); ++part) {
        const Imf::Header& header = file.header(part);
        if (part != layer.part) {
            names.push_back(fmt::format("part {}", header.hasName() ? header.name() : fmt::to_string(part)));
            continue;
        }
        for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
            const std::string name = channel.name();
            const bool is_taken =
                std::find(layer.channels.begin(), layer.channels.end(), name) != layer.channels.end() ||
                (layer.has_chroma && (name == "RY" || name == "BY"));
            if (!is_taken) names.push_back("channel " + name);
        }
    }
    return names;
}

}  // namespace raypool
