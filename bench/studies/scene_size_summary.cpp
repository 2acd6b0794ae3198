#include "bench/studies/scene_size_summary.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "bench/studies/crossover.h"
#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
#include "bench/studies/verdict.h"

namespace raypool::studies {

namespace {

/// Rows of one scene, depth and thread count.
struct Place {
    std::string scene;
    Table rows;
};

Spread ratio_of(const Table& here, const std::string& way) {
    return spread(
        ratios(here.where("way", way).numbers("mpaths_per_s"), here.where("way", kRecursion).numbers("mpaths_per_s")));
}

/// Nothing for what is no number of records.
std::optional<std::int64_t> records_of(const std::string& way) {
    std::int64_t records = 0;
    const auto [end, error] = std::from_chars(way.data(), way.data() + way.size(), records);
    return error == std::errc() && end == way.data() + way.size() ? std::optional(records) : std::nullopt;
}

std::vector<AtCapacity> ratios_by_records(const Table& here) {
    std::vector<AtCapacity> measured;
    for (const Value& way : here.distinct("way"))
        if (const auto records = records_of(way.get<std::string>()))
            measured.push_back({*records, ratio_of(here, way.get<std::string>())});
    return measured;
}

std::vector<Place> places(const Table& data, int threads, const Value& depth) {
    std::vector<Place> found;
    const Table all = data.where("threads", threads).where("depth", depth);
    for (const Value& kind : all.distinct("kind")) {
        const Table of_kind = all.where("kind", kind);
        for (const Value& shapes : of_kind.distinct("shapes"))
            found.push_back(
                {fmt::format("{} {}", shapes.dump(), kind.get<std::string>()), of_kind.where("shapes", shapes)});
    }
    return found;
}

TextTable ratio_table(const Table& data, int threads, const Value& depth) {
    TextTable table{fmt::format("Ratio to recursion, {}, depth {}", threads_text(threads), depth.dump()),
                    {"scene", "trees, MB", "recursion, ns a ray"},
                    {}};
    for (const Place& place : places(data, threads, depth)) {
        const std::vector<AtCapacity> measured = ratios_by_records(place.rows);
        if (table.rows.empty()) {
            for (const AtCapacity& at : measured) table.header.push_back(std::to_string(at.capacity));
            for (const char* more : {"automatic", "its records", "best", "beats recursion from"})
                table.header.emplace_back(more);
        }
        const Table recursion = place.rows.where("way", kRecursion);
        std::vector<std::string> row{place.scene, fmt::format("{:.2f}", 1e-6 * recursion.numbers("tree_bytes").front()),
                                     fmt::format("{:.0f}", median(recursion.numbers("ns_per_segment")))};
        for (const AtCapacity& at : measured) row.push_back(to_text(at.ratio));
        row.push_back(to_text(ratio_of(place.rows, kAutomatic)));
        row.push_back(fmt::format("{:.0f}", place.rows.where("way", kAutomatic).numbers("capacity").front()));
        const auto best =
            std::max_element(measured.begin(), measured.end(),
                             [](const AtCapacity& a, const AtCapacity& b) { return a.ratio.median < b.ratio.median; });
        row.push_back(std::to_string(best->capacity));
        row.push_back(to_text(crossover(measured)));
        table.rows.push_back(std::move(row));
    }
    return table;
}

/// No rows where nothing can count them.
TextTable miss_table(const Table& data, const Value& depth) {
    TextTable table{fmt::format("Cache misses of reads, for each ray, 1 thread, depth {}", depth.dump()),
                    {"scene", "way", "first level", "last level", "counted by"},
                    {}};
    for (const Place& place : places(data, 1, depth)) {
        for (const Value& way : place.rows.distinct("way")) {
            const std::string name = way.get<std::string>();
            if (!name.starts_with(kCounted)) continue;
            const Table rows = place.rows.where("way", way);
            const auto a_ray = [&](const char* column) -> std::string {
                const std::vector<double> counts = rows.numbers(column);
                return counts.empty() ? "" : fmt::format("{:.2f}", counts[0] / rows.numbers("segments")[0]);
            };
            table.rows.push_back({place.scene, name.substr(std::string(kCounted).size() + 2), a_ray("d1_read_misses"),
                                  a_ray("ll_read_misses"), rows.distinct("source").front().get<std::string>()});
        }
    }
    return table;
}

/// Of the default pool. A ray that entered a child is in the list of the next level, unless it went on alone.
TextTable list_table(const Table& data, const Value& depth) {
    TextTable table{fmt::format("Lists of the default pool by level of the trees, 1 thread, depth {}", depth.dump()),
                    {"scene", "level", "rays a list", "lane fill", "rays that enter it in a list, of all rays",
                     "of these, go on alone"},
                    {}};
    for (const Place& place : places(data, 1, depth)) {
        const Table lists = place.rows.where("way", fmt::format("{}, {}", kLists, kAutomatic));
        for (const Value& level : lists.distinct("level")) {
            const Table at = lists.where("level", level);
            const auto figure = [&](const char* column) { return at.numbers(column).front(); };
            const double rays = figure("list_rays");
            const double together = rays - figure("single_rays");
            table.rows.push_back({place.scene, level.dump(), fmt::format("{:.1f}", rays / figure("lists")),
                                  together > 0 ? fmt::format("{:.0f} %", 100 * together / figure("lanes")) : "",
                                  fmt::format("{:.3f}", rays / figure("segments")),
                                  fmt::format("{:.0f} %", 100 * figure("single_rays") / rays)});
        }
    }
    return table;
}

void add_finding(Summary& summary, const Table& data, int threads, const Value& depth, double least) {
    std::string where;
    Spread worst{};
    for (const Place& place : places(data, threads, depth)) {
        const Spread ratio = ratio_of(place.rows, kAutomatic);
        if (!where.empty() && ratio.median >= worst.median) continue;
        worst = ratio;
        where = place.scene;
    }
    summary.findings.push_back(
        {"", fmt::format("the default pool is at least {:g} times as fast as recursion at every size", least), "",
         fmt::format("least for {}: {}, {}, depth {}", where, to_text(worst), threads_text(threads), depth.dump()),
         is_at_least(worst, least), why_open(worst, least)});
}

}  // namespace

Summary summarise_scene_size(const Table& data) {
    Summary summary;
    for (const Value& threads : data.distinct("threads")) {
        for (const Value& depth : data.distinct("depth"))
            summary.tables.push_back(ratio_table(data, threads.get<int>(), depth));
        add_finding(summary, data, threads.get<int>(), data.distinct("depth").back(), 2);
        add_finding(summary, data, threads.get<int>(), data.distinct("depth").back(), 1);
    }
    for (const Value& depth : data.distinct("depth"))
        for (TextTable table : {list_table(data, depth), miss_table(data, depth)})
            if (!table.rows.empty()) summary.tables.push_back(std::move(table));
    summary.pictures.push_back(
        {"ratio", "How the pool's lead depends on the size of the scene",
         "Ratio to recursion by the number of shapes, a line for each capacity, with a band from the lowest to the "
         "highest run; black: the capacity that the trees' bytes choose. What to see: whether a line falls below 1, "
         "and that small pools lead in small scenes and large ones in large scenes."});
    summary.pictures.push_back(
        {"time", "What a ray costs as the scene grows",
         "Nanoseconds of a thread for each ray, by the number of shapes: recursion, and the pool of automatic "
         "capacity. What to see: where the lines bend upward, the trees have outgrown a cache."});
    summary.pictures.push_back(
        {"lists", "How long the lists of rays are on the way down",
         "Above, rays of a list by the level of the trees, a line for each number of shapes, of the pool of automatic "
         "capacity; below, how full the registers are that take them. Grey: shorter lists are taken apart, and their "
         "rays go on alone. What to see: how far down a pool's rays share nodes, and that registers stay full there."});
    summary.notes.push_back(
        "Scenes are made by scenes/generate. A ray across the shapes meets two of them whatever their number, so paths "
        "are equally long in all of them. Making the pool is part of the time. The best capacity is that of the "
        "highest median, and need not differ from its neighbours. Cache misses are counted where the processor lets "
        "us, elsewhere simulated: 32 KiB and 1 MiB, in smaller images, with up to 10^5 shapes. Camera rays are in no "
        "list: they go down in beams.");
    return summary;
}

}  // namespace raypool::studies
