// Feeds two estimators on two threads with whatever may come, for a number of frames or minutes of CPU time, and checks
// that nothing grows, nothing slows down, and no answer is false. Exit 1 where anything does not hold.
// usage: soak [--frames N] [--minutes M] [--seed S]      (N: of each estimator; M: of CPU time, which goes before N)
#include <algorithm>
#include <array>
#include <barrier>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/soak/lane.hpp"
#include "tests/soak/watch.hpp"

namespace nearpose::soak {
namespace {

constexpr int kFramesOfRound = 10;  // between two looks at the memory
constexpr double kWarmUp = 0.2;     // share of the rounds before memory is compared
constexpr double kMemoryChange = 0.01, kLatencyChange = 0.2;
constexpr double kBeyondTolerance = 0.05;  // share of the accepted poses that may be off by up to two tolerances
constexpr int kFewestLatencies = 200;      // fewer say nothing

struct Options {
    long frames = 300;
    double minutes = 0.0;
    std::uint64_t seed = 1;
};

double cpu_s() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The lanes go on in rounds; between them nobody allocates but the look at the memory.
std::vector<MemorySample> run(std::array<Lane, 2>& lanes, const Options& options) {
    std::vector<MemorySample> samples;
    samples.reserve(1 << 16);  // no growth of its own
    bool done = false;
    const double begin_s = cpu_s();
    double told_s = begin_s;
    const auto after_round = [&]() noexcept {
        samples.push_back(memory_now());
        const long frames = static_cast<long>(samples.size()) * kFramesOfRound;
        const double used_s = cpu_s() - begin_s;
        done = options.minutes > 0.0 ? used_s >= 60.0 * options.minutes : frames >= options.frames;
        if (cpu_s() - told_s < 30.0) return;
        told_s = cpu_s();
        std::fprintf(stderr, "%ld frames each, %.0f s of CPU time, resident %.1f MiB, live %.2f MiB\n", frames, used_s,
                     samples.back().resident_mib, samples.back().live_mib);
    };
    std::barrier round_ends(static_cast<std::ptrdiff_t>(lanes.size()), after_round);
    const auto feed = [&](Lane& lane) {
        while (!done) {
            for (int k = 0; k < kFramesOfRound; ++k) lane.feed();
            round_ends.arrive_and_wait();
        }
    };
    std::thread other(feed, std::ref(lanes[1]));
    feed(lanes[0]);
    other.join();
    return samples;
}

// Prints a row; whether the change is within the limit.
bool print_halves(const char* what, const char* unit, const Halves& halves, double limit, bool counts) {
    const bool holds = halves.change() <= limit;
    std::printf("%-34s %10.3f %10.3f %-4s %+7.2f %%  %s\n", what, halves.first, halves.second, unit,
                100.0 * halves.change(),
                !counts ? "(too few)"
                : holds ? "holds"
                        : "DOES NOT HOLD");
    return holds || !counts;
}

bool print_memory(const std::vector<MemorySample>& samples) {
    std::vector<double> resident, live;
    for (auto k = static_cast<std::size_t>(std::ceil(kWarmUp * static_cast<double>(samples.size())));
         k < samples.size(); ++k) {
        resident.push_back(samples[k].resident_mib);
        live.push_back(samples[k].live_mib);
    }
    const bool counts = resident.size() >= 8;
    const bool resident_holds = print_halves("resident memory", "MiB", halves_of(resident), kMemoryChange, counts);
    return print_halves("live bytes", "MiB", halves_of(live), kMemoryChange, counts) && resident_holds;
}

bool print_latency(const Lane& lane) {
    std::vector<double> milliseconds;
    for (const double seconds : lane.counts().tracked_cpu_s) milliseconds.push_back(1e3 * seconds);
    const Halves halves = halves_of(milliseconds);
    return print_halves("CPU time of a frame in tracking", "ms", halves, kLatencyChange,
                        halves.samples >= kFewestLatencies);
}

void print_counts(const LaneCounts& counts, int number) {
    std::printf("estimator %d: %d estimated, %d accepted, %zu in tracking at the usual size\n", number,
                counts.estimated, counts.accepted, counts.tracked_cpu_s.size());
    for (const auto& [kind, count] : counts.fed) std::printf("    fed %-30s %7d\n", kind.c_str(), count);
    for (const auto& [what, count] : counts.breaches) std::printf("    DOES NOT HOLD: %s %d\n", what.c_str(), count);
    for (const std::string& breach : counts.first_breaches) std::printf("        %s\n", breach.c_str());
    for (const std::string& error : counts.beyond_tolerance)
        std::printf("    accepted at one to two tolerances: %s\n", error.c_str());
}

bool print_answers(const std::array<Lane, 2>& lanes) {
    bool hold = true;
    std::size_t accepted = 0, beyond = 0;
    for (const Lane& lane : lanes) {
        print_counts(lane.counts(), static_cast<int>(&lane - lanes.data()));
        hold = hold && lane.counts().breaches.empty();
        accepted += static_cast<std::size_t>(lane.counts().accepted);
        beyond += lane.counts().beyond_tolerance.size();
    }
    const double share = static_cast<double>(beyond) / static_cast<double>(std::max<std::size_t>(1, accepted));
    std::printf("accepted at one to two tolerances: %zu of %zu, %.2f %%  %s\n", beyond, accepted, 100.0 * share,
                share <= kBeyondTolerance ? "holds" : "DOES NOT HOLD");
    return hold && share <= kBeyondTolerance;
}

// Whether all holds.
bool soak(const Options& options) {
    const Recordings recordings = make_recordings(options.seed);
    // One thread: its CPU time is all that an update takes. Two threads: those of the parallel loop.
    std::array<Lane, 2> lanes = {Lane(recordings, options.seed, 1), Lane(recordings, options.seed + 1, 2)};
    const std::vector<MemorySample> samples = run(lanes, options);
    std::printf("%zu frames each, %.0f s of CPU time, seed %llu\n", samples.size() * kFramesOfRound, cpu_s(),
                static_cast<unsigned long long>(options.seed));
    std::printf("%-34s %10s %10s\n", "medians of the halves", "first", "second");
    const bool memory_holds = print_memory(samples), latency_holds = print_latency(lanes[0]);
    const bool seen = lanes[0].counts().accepted > 0 && lanes[1].counts().accepted > 0;
    if (!seen) std::printf("DOES NOT HOLD: an estimator never accepted a pose\n");
    return print_answers(lanes) && memory_holds && latency_holds && seen;
}

Options options_of(const std::vector<std::string>& words) {
    Options options;
    for (std::size_t k = 0; k < words.size(); k += 2) {
        if (k + 1 == words.size()) throw std::invalid_argument(words[k] + ": a number is needed after it");
        if (words[k] == "--frames")
            options.frames = std::stol(words[k + 1]);
        else if (words[k] == "--minutes")
            options.minutes = std::stod(words[k + 1]);
        else if (words[k] == "--seed")
            options.seed = std::stoull(words[k + 1]);
        else
            throw std::invalid_argument(words[k] + ": is none of --frames, --minutes, --seed");
    }
    return options;
}

}  // namespace
}  // namespace nearpose::soak

int main(int argc, char** argv) {
    try {
        return nearpose::soak::soak(nearpose::soak::options_of({argv + 1, argv + argc})) ? 0 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "soak: %s\n", error.what());
        return 2;
    }
}
