#include "bench/studies/cache_counts.h"

#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/studies/process.h"
#include "core/base/scratch_folder.h"
#include "core/math/processor.h"
#include "core/runtime/environment.h"

namespace raypool::studies {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// One event of this thread, in user space; it counts from start() to stop().
class Event {
  public:
    Event(std::uint64_t cache, std::uint64_t operation, std::uint64_t result) {
        perf_event_attr attributes;
        std::memset(&attributes, 0, sizeof(attributes));
        attributes.size = sizeof(attributes);
        attributes.type = PERF_TYPE_HW_CACHE;
        attributes.config = cache | operation << 8U | result << 16U;
        attributes.disabled = 1;
        attributes.exclude_kernel = 1;
        attributes.exclude_hv = 1;
        attributes.read_format = PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING;
        file_ = static_cast<int>(syscall(SYS_perf_event_open, &attributes, 0, -1, -1, PERF_FLAG_FD_CLOEXEC));
    }
    Event(const Event&) = delete;
    Event& operator=(const Event&) = delete;
    ~Event() {
        if (file_ >= 0) close(file_);
    }

    [[nodiscard]] bool exists() const { return file_ >= 0; }
    void start() const {
        if (exists()) ioctl(file_, PERF_EVENT_IOC_ENABLE, 0);
    }
    void stop() const {
        if (exists()) ioctl(file_, PERF_EVENT_IOC_DISABLE, 0);
    }
    /// Scaled up where the event shared its counter with others.
    [[nodiscard]] std::optional<std::int64_t> count() const {
        struct {
            std::uint64_t value, enabled, running;
        } read_back{};
        if (!exists() || read(file_, &read_back, sizeof(read_back)) != sizeof(read_back) || read_back.running == 0)
            return std::nullopt;
        return static_cast<std::int64_t>(static_cast<double>(read_back.value) * static_cast<double>(read_back.enabled) /
                                         static_cast<double>(read_back.running));
    }

  private:
    int file_;
};

json read_json(const std::string& path) {
    std::ifstream file(path);
    return json::parse(file, nullptr, false);
}

bool has_valgrind() {
    std::istringstream folders(std::getenv("PATH") == nullptr ? "" : std::getenv("PATH"));
    for (std::string folder; std::getline(folders, folder, ':');)
        if (access((folder + "/valgrind").c_str(), X_OK) == 0) return true;
    return false;
}

/// The commit that a raypool command was built of; empty where it cannot be told.
std::string commit_of(const fs::path& command) {
    const ScratchFolder scratch;
    const std::string stats = (scratch / "stats.json").string();
    const int status = run_process(
        {command.string(), "render", "--width", "1", "--spp", "1", "--threads", "1", "--quiet", "--stats", stats});
    const json found = status == 0 ? read_json(stats) : json();
    return found.is_object() ? found.value(json::json_pointer("/environment/commit"), std::string()) : std::string();
}

CachegrindCommand find_command() {
    if (!has_valgrind()) return {{}, "valgrind is not installed"};
    const fs::path own = fs::read_symlink("/proc/self/exe");
    if (kIsKnownToValgrind) return {own, ""};
    const fs::path twin = own.parent_path() / "../../portable/cli/raypool";
    if (!fs::exists(twin)) return {{}, "valgrind knows no AVX-512 and no SVE: build the preset portable"};
    if (commit_of(twin) != environment_json().at("commit").get<std::string>())
        return {{}, "the build of the preset portable is of another commit: build it again"};
    return {fs::canonical(twin), ""};
}

}  // namespace

std::optional<CacheCounts> count_by_hardware(const std::function<void()>& work) {
    constexpr std::uint64_t kRead = PERF_COUNT_HW_CACHE_OP_READ;
    constexpr std::uint64_t kWrite = PERF_COUNT_HW_CACHE_OP_WRITE;
    constexpr std::uint64_t kAccess = PERF_COUNT_HW_CACHE_RESULT_ACCESS;
    constexpr std::uint64_t kMiss = PERF_COUNT_HW_CACHE_RESULT_MISS;
    const Event events[] = {{PERF_COUNT_HW_CACHE_L1D, kRead, kAccess}, {PERF_COUNT_HW_CACHE_L1D, kWrite, kAccess},
                            {PERF_COUNT_HW_CACHE_L1D, kRead, kMiss},   {PERF_COUNT_HW_CACHE_L1D, kWrite, kMiss},
                            {PERF_COUNT_HW_CACHE_LL, kRead, kMiss},    {PERF_COUNT_HW_CACHE_LL, kWrite, kMiss}};
    if (!events[0].exists() || !events[2].exists()) return std::nullopt;  // a rate of misses needs these two
    for (const Event& event : events) event.start();
    work();
    for (const Event& event : events) event.stop();
    return CacheCounts{events[0].count(), events[1].count(), events[2].count(),
                       events[3].count(), events[4].count(), events[5].count()};
}

const CachegrindCommand& cachegrind_command() {
    static const CachegrindCommand command = find_command();
    return command;
}

CacheCounts read_cachegrind(std::istream& file, const std::function<bool(const std::string&)>& is_wanted) {
    std::vector<std::string> events;
    std::map<std::string, std::int64_t> sums;
    bool is_inside = false;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line.substr(line.find_first_of(" =:") + 1));
        if (line.starts_with("events:")) {
            for (std::string event; words >> event;) events.push_back(event);
        } else if (line.starts_with("fn=")) {
            is_inside = is_wanted(line.substr(3));
        } else if (is_inside && !line.empty() && line.front() >= '0' && line.front() <= '9') {
            std::int64_t count = 0;
            for (std::size_t i = 0; i < events.size() && words >> count; ++i) sums[events[i]] += count;
        }
    }
    const auto sum = [&](const char* event) {
        if (std::find(events.begin(), events.end(), event) == events.end())
            throw std::runtime_error(fmt::format("cachegrind counted no {}", event));
        return sums[event];
    };
    return {sum("Dr"), sum("Dw"), sum("D1mr"), sum("D1mw"), sum("DLmr"), sum("DLmw")};
}

Cachegrind run_cachegrind(const std::vector<std::string>& arguments) {
    const ScratchFolder scratch;
    const std::string counts = (scratch / "counts").string();
    const std::string stats = (scratch / "stats.json").string();
    std::vector<std::string> all{"valgrind",
                                 "--tool=cachegrind",
                                 "--cache-sim=yes",
                                 std::string("--D1=") + kSimulatedD1,
                                 std::string("--LL=") + kSimulatedLl,
                                 "--cachegrind-out-file=" + counts,
                                 "--log-file=" + (scratch / "log").string(),
                                 cachegrind_command().path.string(),
                                 "render"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), {"--quiet", "--stats", stats});
    if (const int status = run_process(all); status != 0)
        throw std::runtime_error(fmt::format("valgrind --tool=cachegrind: exit status {}", status));

    const auto is_engine = [](const std::string& name) {
        return name.find("raypool::wavefront::") != std::string::npos && name.find("::finish(") == std::string::npos;
    };
    const auto is_adding = [](const std::string& name) {
        return name.find("raypool::wavefront::add_integers<") != std::string::npos ||
               (name.find("Int64<") != std::string::npos && name.find(">::add(") != std::string::npos);
    };
    const auto read = [&](const auto& is_wanted) {
        std::ifstream file(counts);
        return read_cachegrind(file, is_wanted);
    };
    const json found = read_json(stats);
    if (!found.is_object()) throw std::runtime_error("valgrind --tool=cachegrind: the command wrote no statistics");
    return {read(is_engine), read(is_adding), read([](const std::string&) { return true; }),
            found.at("segments").get<std::int64_t>(), found.at("hash").get<std::string>()};
}

}  // namespace raypool::studies
