#include "core/exr_layer.h"

#include <OpenEXR/ImfChannelList.h>

#include <algorithm>
#include <optional>
#include <set>

namespace raypool {
namespace {

std::optional<ExrLayer::Kind> kind_of(const Imf::ChannelList& channels, const ExrLayer& layer) {
    const auto has = [&](const char* name) { return channels.findChannel(layer.channel(name)) != nullptr; };
    if (has("R") && has("G") && has("B")) return ExrLayer::Kind::Colour;
    if (!has("Y")) return {};
    return has("RY") && has("BY") ? ExrLayer::Kind::LuminanceAndChroma : ExrLayer::Kind::Luminance;
}

/// Every layer of the part that is a picture.
std::vector<ExrLayer> layers_of(const std::vector<ExrPart>& parts, std::size_t part) {
    const Imf::ChannelList& channels = parts[part].header.channels();
    std::set<std::string> names;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        const std::string name = channel.name();
        const std::size_t dot = name.rfind('.');
        names.insert(dot == std::string::npos ? "" : name.substr(0, dot));
    }
    std::vector<ExrLayer> layers;
    for (const std::string& name : names) {
        ExrLayer layer{part, ExrLayer::Kind::Colour, name};
        if (const auto kind = kind_of(channels, layer)) {
            layer.kind = *kind;
            layers.push_back(std::move(layer));
        }
    }
    return layers;
}

}  // namespace

std::vector<std::string> ExrLayer::channels() const {
    if (kind == Kind::Colour) return {channel("R"), channel("G"), channel("B")};
    if (kind == Kind::Luminance) return {channel("Y")};
    return {channel("Y"), channel("RY"), channel("BY")};
}

ExrLayer exr_layer(const std::vector<ExrPart>& parts) {
    std::vector<ExrLayer> unclear;
    for (std::size_t part = 0; part < parts.size(); ++part) {
        if (parts[part].is_deep) continue;
        const std::vector<ExrLayer> layers = layers_of(parts, part);
        if (layers.size() == 1 || (!layers.empty() && layers.front().layer.empty())) return layers.front();
        if (unclear.empty()) unclear = layers;
    }
    if (!unclear.empty()) {
        throw std::runtime_error(
            fmt::format("must have R, G and B without a layer's name, or in one layer; got {} "
                        "layers, such as {} and {}",
                        unclear.size(), unclear[0].layer, unclear[1].layer));
    }
    const bool is_deep = std::all_of(parts.begin(), parts.end(), [](const ExrPart& part) { return part.is_deep; });
    throw std::runtime_error(is_deep ? "holds deep data, which is not read"
                                     : "must have channels R, G and B, or Y, in a part that is not deep");
}

std::vector<std::string> other_channels(const std::vector<ExrPart>& parts, const ExrLayer& layer) {
    const std::vector<std::string> read = layer.channels();
    std::vector<std::string> others;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const Imf::Header& header = parts[i].header;
        for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
            const std::string name = channel.name();
            if (i != layer.part) {
                others.push_back((header.hasName() ? header.name() : fmt::format("part {}", i)) + ':' + name);
            } else if (std::find(read.begin(), read.end(), name) == read.end()) {
                others.push_back(name);
            }
        }
    }
    return others;
}

}  // namespace raypool
