// One estimator that is fed with all that may come, and what its answers must be whatever comes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/estimator.hpp"
#include "tests/soak/recordings.hpp"

namespace nearpose::soak {

struct LaneCounts {
    std::map<std::string, int> fed;       // frames by kind
    std::map<std::string, int> breaches;  // by what does not hold
    std::vector<std::string> first_breaches;
    int estimated = 0, accepted = 0;
    // Accepted poses that are off by one to two tolerances. The verdict asks for a 90 % region within the tolerance, so
    // a few may be.
    std::vector<std::string> beyond_tolerance;
    std::vector<double> tracked_cpu_s;  // of updates in tracking, images of the usual size; of the calling thread
};

// Belongs to one thread. The same seed feeds the same.
class Lane {
  public:
    Lane(const Recordings& recordings, std::uint64_t seed, int threads);

    // One observation, one update, all checks.
    void feed();
    const LaneCounts& counts() const { return counts_; }

  private:
    // Of the present piece.
    struct Piece {
        int recording = 0, next = 0, end = 0;
        bool with_mask = true;
    };
    struct Kept {
        Belief belief;
        Pose camera_from_world;  // of its last frame
        int recording = 0;
    };

    int draw(int count) { return static_cast<int>(random_() % static_cast<std::uint64_t>(count)); }
    bool chance(int percent) { return draw(100) < percent; }
    void begin_piece();
    void keep_or_put_back();
    std::optional<Pose> motion_to(const Pose& camera_from_world);
    void feed_piece();
    void feed_nonsense();
    void update(const Frame& frame, const std::optional<Mask>& mask, const std::optional<Pose>& now_from_before,
                const std::string& kind);
    void check(const UpdateResult& result, const Frame& frame, const std::string& kind);
    void breach(const std::string& what, const std::string& detail);

    const Recordings& recordings_;
    PoseEstimator estimator_;
    std::mt19937_64 random_;
    Piece piece_;
    std::optional<Pose> camera_from_world_before_;
    std::optional<Kept> kept_;
    std::string history_;  // of the last frames, newest last
    LaneCounts counts_;
};

}  // namespace nearpose::soak
