#include "apps/data_set/bop_stamps.hpp"

#include <gtest/gtest.h>

#include "tests/apps/data_set/scene_files.hpp"

namespace nearpose::data_set {
namespace {

class Stamps : public SceneFiles {
  protected:
    BopScene stamped(const std::vector<std::string>& stamps) {
        std::vector<std::string> entries;
        for (const std::string& stamp : stamps)
            entries.push_back(kK + (stamp.empty() ? "" : ", \"timestamp\": " + stamp));
        return open(entries);
    }
    static std::vector<double> of(const BopScene& scene) {
        std::vector<double> stamps_s;
        for (const Frame& frame : scene.frames) stamps_s.push_back(frame.stamp_s);
        return stamps_s;
    }
};

// Missing, null, repeated, backwards: the frame's stamp lies between its neighbours', and it is said.
TEST_F(Stamps, ThatMakeNoSenseLieBetweenTheirNeighbours) {
    for (const char* bad : {"", "null", "NaN", "1.0", "0.5"}) {
        const BopScene scene = stamped({"1.0", bad, "3.0", "4.0"});
        EXPECT_EQ(of(scene), (std::vector<double>{1.0, 2.0, 3.0, 4.0})) << bad;
        expect_notice(scene.time_notices, {"scene_camera.json: 1", "timestamp", "between its neighbours'"});
    }
}

TEST_F(Stamps, ThatRunAheadOnceDoNotSpoilTheOthers) {
    const BopScene scene = stamped({"1.0", "900.0", "3.0", "4.0"});
    EXPECT_EQ(of(scene), (std::vector<double>{1.0, 2.0, 3.0, 4.0}));
    expect_notice(scene.time_notices, {"900"});
}

TEST_F(Stamps, AtTheEndsGoOnAsTheOthers) {
    const BopScene scene = stamped({"", "1.0", "1.5", ""});
    EXPECT_EQ(of(scene), (std::vector<double>{0.5, 1.0, 1.5, 2.0}));
    expect_notice(scene.time_notices, {"the same in 1 more frame (the last: 3)"});
    EXPECT_NEAR(stamped({"7.0", ""}).frames[1].stamp_s, 7.0 + 1.0 / 30.0, 1e-12);  // by the frame rate
}

TEST_F(Stamps, WithoutAnyAreThoseOfTheFrameRate) {
    EXPECT_NEAR(stamped({"", "", ""}).frames[2].stamp_s, 2.0 / 30.0, 1e-12);
    const BopScene scene = stamped({"null", "null"});
    EXPECT_NEAR(scene.frames[1].stamp_s, 1.0 / 30.0, 1e-12);
    EXPECT_FALSE(scene.has_timestamps);
}

TEST_F(Stamps, WithGapsAreKeptAndTheGapsSaid) {
    const BopScene scene = stamped({"0.0", "0.1", "0.2", "9.2", "9.3", "9.4"});
    EXPECT_EQ(scene.frames[3].stamp_s, 9.2);
    expect_notice(scene.time_notices, {"1 gap", "9.00 s before frame 3", "usual are 0.100 s"});
}

}  // namespace
}  // namespace nearpose::data_set
