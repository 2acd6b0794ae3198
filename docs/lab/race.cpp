// A race in an accumulator: threads add contributions to the sums of a few pixels.
//   g++ -O2 -fopenmp docs/lab/race.cpp -o out/race
//   out/race MODE [THREADS]
// MODE is one of
//   racy     threads add to shared sums, and nothing orders them
//   halves   an addition is an atomic read and an atomic write; barriers between them lose updates in every run
//   atomic   an addition is one atomic update
//   private  a copy of the sums for each thread; the copies are added up at the end
//   owned    each pixel belongs to one thread, and no other adds to it
#include <omp.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

constexpr int kPixels = 4;
constexpr int kContributions = 4'000'000;  // of 1 each

// volatile: every addition reads and writes memory, as it does where pixels are too many for registers.
volatile long sums[kPixels];

// 64 samples of a pixel follow each other, and the loops below deal them out to the threads one by one.
int pixel_of(int contribution) {
    return contribution / 64 % kPixels;
}

void add_racily(int contribution) {
    const int pixel = pixel_of(contribution);
    const long sum = sums[pixel];
    if (contribution % 1000 < 2)
        std::this_thread::yield();  // as an interrupt may: then one core is enough for the race
    sums[pixel] = sum + 1;
}

void add_in_halves(int rounds) {  // by every thread of a team, all at the same time
    for (int i = 0; i < rounds; ++i) {
        long sum;
#pragma omp atomic read
        sum = sums[0];
#pragma omp barrier
#pragma omp atomic write
        sums[0] = sum + 1;
#pragma omp barrier
    }
}

int main(int count, char** words) {
    const std::string mode = count > 1 ? words[1] : "racy";
    const int threads = count > 2 ? std::atoi(words[2]) : 2;
    std::vector<std::vector<long>> copies(static_cast<std::size_t>(threads), std::vector<long>(kPixels));

#pragma omp parallel num_threads(threads)
    {
#pragma omp barrier  // all are there
        if (mode == "racy") {
#pragma omp for schedule(static, 1)
            for (int i = 0; i < kContributions; ++i) add_racily(i);
        } else if (mode == "halves") {
            add_in_halves(1000);
        } else if (mode == "atomic") {
#pragma omp for schedule(static, 1)
            for (int i = 0; i < kContributions; ++i)
#pragma omp atomic
                sums[pixel_of(i)] += 1;
        } else if (mode == "private") {
#pragma omp for schedule(static, 1)
            for (int i = 0; i < kContributions; ++i) copies[omp_get_thread_num()][pixel_of(i)] += 1;
        } else if (mode == "owned") {
            for (int i = 0; i < kContributions; ++i)
                if (pixel_of(i) % threads == omp_get_thread_num()) sums[pixel_of(i)] = sums[pixel_of(i)] + 1;
        }
    }
    const long right = mode == "halves" ? 1000L * threads : kContributions;
    long sum = sums[0] + sums[1] + sums[2] + sums[3];
    for (const std::vector<long>& copy : copies) sum += copy[0] + copy[1] + copy[2] + copy[3];
    std::printf("%s: sum %ld of %ld, lost %ld\n", mode.c_str(), sum, right, right - sum);
}
