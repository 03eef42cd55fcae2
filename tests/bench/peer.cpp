// Prints how exact nearpose is beside a plain robust point-to-plane fit that starts near the truth of each frame.
// usage: nearpose_peer [SEED] [--parts-of-fit] [WORD...]    WORDs: only recordings whose names hold one of them
//   --parts-of-fit   nearpose started near the truth as well, with parts of its fit switched off one by one
// A row: mean error [mm], [deg]; z: mean signed error of the depth [mm]; share of the depth explained to 1 mm [%].
// "nearpose" runs from nothing through the recording; all others start near the truth in each frame.
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "tests/bench/peer_runs.hpp"

namespace nearpose::bench {
namespace {

constexpr int kFirst = 4;  // frames before are left out: from nothing, nearpose has to find the part first

std::vector<PeerCase> cases() {
    // The camera's own least range would leave the last third of an approach without depth.
    constexpr double kNear_m = 0.1;
    std::vector<PeerCase> all;
    for (const char* scenario : {"piston", "sweep", "handheld"})
        all.push_back({scenario, "engine_block", "stereo_d435", kNear_m});
    all.push_back({"piston", "engine_block", "stereo_d405"});
    // The bracket's own sweep ends where neither camera measures.
    for (const char* sensor : {"stereo_d435", "stereo_d405"})
        all.push_back({"sweep", "bracket", sensor, kNear_m, PeerCase{}.frames, 1, 0.3, 0.13});
    all.push_back({"piston", "engine_block", "d435"});
    return all;
}

struct NamedChange {
    const char* name;
    Change change;
};

std::vector<NamedChange> parts_of_fit() {
    return {{"all", unchanged},
            {"no fit", [](Method& method, SensorModel&) { method.fusion = false; }},
            {"edges as sharp", [](Method&, SensorModel& sensor) { sensor.edge_sigma_factor = 1.0; }},
            {"no field", [](Method&, SensorModel& sensor) { sensor.systematic_fitted = 1e-3; }},
            {"whole field", [](Method&, SensorModel& sensor) { sensor.systematic_fitted = 1.0; }},
            {"no scale", [](Method&, SensorModel& sensor) { sensor.scale_fitted = 1e-3; }},
            {"no lateral noise", [](Method&, SensorModel& sensor) { sensor.lateral_sigma_pixels = 0.0; }},
            {"no fine error", [](Method&, SensorModel& sensor) { sensor.systematic_fine_sigma_m = 0.0; }},
            {"own pixel alone", [](Method& method, SensorModel&) { method.fit.rays.reach_spacings = 0.0; }},
            {"gate of 3 sigmas", [](Method& method, SensorModel&) { method.fit.rays.gate_sigmas = 3.0; }},
            {"Huber at 1 sigma", [](Method& method, SensorModel&) { method.fit.rays.huber_sigmas = 1.0; }},
            {"8 rounds", [](Method& method, SensorModel&) { method.fit.max_rounds = 8; }}};
}

void print(const char* name, const FitErrors& errors) {
    std::printf("  %-34s %2d frames  %5.2f mm  %5.3f deg  z %+5.2f mm  %4.1f %%\n", name, errors.frames,
                errors.translation_mm, errors.rotation_deg, errors.depth_mm, 100.0 * errors.explained);
    std::fflush(stdout);
}

void run(const PeerCase& of, const std::string& name, bool with_parts) {
    const PeerScene scene(of);
    std::printf("%s: the truth explains %.1f %%\n", name.c_str(), 100.0 * explained_by_truth(scene, kFirst));
    naive::PlaneFitOptions nearest;
    nearest.pairing = naive::Pairing::kNearest;
    print("nearpose, mask", tracked(scene, true, kFirst));
    print("nearpose near the truth, mask", started_near(scene, true, kFirst));
    print("plain, projective, mask", plainly_fitted(scene, true, kFirst));
    print("plain, nearest, mask", plainly_fitted(scene, true, kFirst, nearest));
    print("nearpose, no mask", tracked(scene, false, kFirst));
    print("plain, projective, no mask", plainly_fitted(scene, false, kFirst));
    for (const NamedChange& part : with_parts ? parts_of_fit() : std::vector<NamedChange>{})
        print((std::string("near the truth: ") + part.name).c_str(), started_near(scene, true, kFirst, part.change));
    if (!with_parts) return;
    print("tracked: no fit", tracked(scene, true, kFirst, [](Method& method, SensorModel&) { method.fusion = false; }));
    print("tracked: frames average nothing out",
          tracked(scene, true, kFirst, [](Method& method, SensorModel&) { method.track.independent_errors = 0.0; }));
}

bool asked_for(const std::string& name, const std::vector<std::string>& words) {
    bool found = words.empty();
    for (const std::string& word : words) found |= name.find(word) != std::string::npos;
    return found;
}

}  // namespace
}  // namespace nearpose::bench

int main(int argc, char** argv) {
    try {
        std::vector<std::string> words(argv + 1, argv + argc);
        const bool with_parts = std::erase(words, "--parts-of-fit") > 0;
        const bool with_seed = !words.empty() && words.front().find_first_not_of("0123456789") == std::string::npos;
        const std::uint64_t seed = with_seed ? std::stoull(words.front()) : 1;
        if (with_seed) words.erase(words.begin());
        for (nearpose::bench::PeerCase of : nearpose::bench::cases()) {
            of.seed = seed;
            const std::string name = of.sensor + " " + of.part + " " + of.scenario;
            if (nearpose::bench::asked_for(name, words)) nearpose::bench::run(of, name, with_parts);
        }
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "nearpose_peer: %s\n", error.what());
        return 1;
    }
}
