// False sharing: each thread counts in a counter of its own, and the counters lie on one cache line or on several.
//   g++ -O2 -fopenmp docs/lab/false_sharing.cpp -o out/false_sharing
//   out/false_sharing MODE [THREADS]
// MODE is one of
//   packed  counters of eight bytes side by side, eight on a cache line
//   padded  a cache line for each counter
//   local   counted in a register, and written to the packed counter once
#include <omp.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>

constexpr int kMostThreads = 64;
constexpr long kCounts = 200'000'000;  // of all threads
constexpr std::uintptr_t kLine = 64;   // bytes

// volatile: every count reads and writes memory.
struct Packed {
    volatile long count = 0;
};
struct alignas(kLine) Padded {
    volatile long count = 0;
};
alignas(kLine) Packed packed[kMostThreads];
Padded padded[kMostThreads];

template <class Counter>
int count_and_report(const std::string& mode, Counter* counters, int threads) {
    const double start = omp_get_wtime();
#pragma omp parallel num_threads(threads)
    {
        Counter& own = counters[omp_get_thread_num()];
        const long counts = kCounts / threads;
        if (mode == "local") {
            long count = 0;
            for (long i = 0; i < counts; ++i) {
                count += 1;
                asm volatile("" : "+r"(count));  // else the compiler knows the sum without a loop
            }
            own.count = count;
        } else {
            for (long i = 0; i < counts; ++i) own.count = own.count + 1;
        }
    }
    const double seconds = omp_get_wtime() - start;

    long sum = 0;
    std::set<std::uintptr_t> lines;
    for (int i = 0; i < threads; ++i) {
        sum += counters[i].count;
        lines.insert(reinterpret_cast<std::uintptr_t>(&counters[i]) / kLine);
    }
    std::printf("%s: %d counters of %zu bytes on %zu cache lines, sum %ld, %.3f s\n", mode.c_str(), threads,
                sizeof(Counter), lines.size(), sum, seconds);
    return 0;
}

int main(int count, char** words) {
    const std::string mode = count > 1 ? words[1] : "";
    const int threads = count > 2 ? std::atoi(words[2]) : 2;
    omp_set_dynamic(0);
    if (threads >= 1 && threads <= kMostThreads) {
        if (mode == "packed" || mode == "local") return count_and_report(mode, packed, threads);
        if (mode == "padded") return count_and_report(mode, padded, threads);
    }
    std::fprintf(stderr, "usage: false_sharing packed|padded|local [THREADS, at most %d]\n", kMostThreads);
    return 2;
}
