#include "core/evidence/verdict.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

namespace nearpose {
namespace {

// Passes every test.
Evidence flawless() {
    Evidence evidence;
    evidence.seen = true;
    evidence.pixels.segmented = true;
    evidence.pixels.model_rays = 1000;
    evidence.pixels.agreeing = 980;
    evidence.pixels.contradicted = 10;
    evidence.pixels.missing_model = 20;
    evidence.pixels.outline = 100;
    evidence.pixels.coplanar = 10;
    evidence.alternatives_tried = true;
    evidence.covariance_about_centre = 1e-8 * Matrix6d::Identity();
    return evidence;
}

Verdict verdict_of(const Evidence& evidence) {
    return judge(evidence, Tolerance{}, Symmetries{});
}

TEST(Verdict, AcceptsAPoseThatPassesEveryTest) {
    EXPECT_EQ(verdict_of(flawless()), Verdict::kAccept);
}

TEST(Verdict, APoseThatIsNotSeenOrIsContradictedIsLost) {
    Evidence evidence = flawless();
    evidence.seen = false;
    EXPECT_EQ(verdict_of(evidence), Verdict::kLost);
    evidence = flawless();
    evidence.pixels.contradicted = 900;
    EXPECT_EQ(verdict_of(evidence), Verdict::kLost);
}

TEST(Verdict, OneFailedTestIsEnoughToContinue) {
    const std::vector<std::function<void(Evidence&)>> failures = {
        [](Evidence& e) { e.pixels.contradicted = 150; },                      // much of what is seen disagrees
        [](Evidence& e) { e.pixels.model_rays = 10000; },                      // hardly any of the model is seen
        [](Evidence& e) { e.pixels.coplanar = 80; },                           // coplanar with its surroundings
        [](Evidence& e) { e.pixels.missing_model = 5000; },                    // the mask is much larger than the model
        [](Evidence& e) { e.alternatives_weight = 0.3; },                      // another pose explains it as well
        [](Evidence& e) { e.alternatives_tried = false; },                     // no alternative was tried
        [](Evidence& e) { e.covariance_about_centre(4, 4) = 0.002 * 0.002; },  // known to 5 mm only
        [](Evidence& e) { e.covariance_about_centre(0, 0) = 0.02 * 0.02; },    // known to 3 degrees only
    };
    for (std::size_t k = 0; k < failures.size(); ++k) {
        Evidence evidence = flawless();
        failures[k](evidence);
        EXPECT_EQ(verdict_of(evidence), Verdict::kContinue) << k;
    }
}

TEST(Verdict, RotationAboutAnAxisOfRevolutionDoesNotCount) {
    Evidence evidence = flawless();
    evidence.covariance_about_centre(2, 2) = 1.0;
    Symmetries shaft;
    shaft.continuous.push_back({Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()});
    EXPECT_EQ(judge(evidence, Tolerance{}, shaft), Verdict::kAccept);
    EXPECT_EQ(judge(evidence, Tolerance{}, Symmetries{}), Verdict::kContinue);
}

TEST(Verdict, AnImprecisePoseMayBeVerified) {
    Evidence evidence = flawless();
    evidence.covariance_about_centre = Matrix6d::Identity();
    EXPECT_TRUE(is_verified(evidence));
    evidence.alternatives_weight = 0.3;
    EXPECT_FALSE(is_verified(evidence));
}

TEST(Verdict, ToleranceIsTheUsers) {
    Evidence evidence = flawless();
    evidence.covariance_about_centre(4, 4) = 0.001 * 0.001;  // 90 % region: 2.5 mm
    EXPECT_EQ(judge(evidence, Tolerance{0.002, 0.0175}, Symmetries{}), Verdict::kContinue);
    EXPECT_EQ(judge(evidence, Tolerance{0.003, 0.0175}, Symmetries{}), Verdict::kAccept);
}

}  // namespace
}  // namespace nearpose
