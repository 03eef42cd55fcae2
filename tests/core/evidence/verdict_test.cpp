#include "core/evidence/verdict.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

namespace nearpose {
namespace {

// Passes every test.
Evidence flawless() {
    Evidence evidence;
    evidence.seen = true;
    evidence.log_odds_present = 20.0;
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
    return judge(evidence, Tolerance{}, Symmetries{}).verdict;
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
    evidence = flawless();
    evidence.log_odds_present = -2.3;  // a probability of 0.09
    EXPECT_EQ(verdict_of(evidence), Verdict::kLost) << "walls explain the image as well";
}

// What is wrong with the evidence, and how the verdict says it.
struct Flaw {
    std::function<void(Evidence&)> make;
    Requirement requirement;
    std::string text;
};

TEST(Verdict, NamesWhatIsMissingWithFigureAndLimit) {
    const std::vector<Flaw> flaws = {
        {[](Evidence& e) { e.log_odds_present = 2.0; }, Requirement::kPresence,
         "the image hardly shows more than planes: 2.0 nats, wanted 5.0"},
        {[](Evidence& e) { e.pixels.contradicted = 150; }, Requirement::kAgreement,
         "too little agrees: 0.87, wanted 0.93"},
        {[](Evidence& e) { e.pixels.model_rays = 10000; }, Requirement::kSupport,
         "too little of the model is seen: 0.10, wanted 0.30"},
        {[](Evidence& e) { e.pixels.coplanar = 80; }, Requirement::kOutline,
         "surfaces go on where the model ends: 0.80 of its outline, wanted 0.40 at most"},
        {[](Evidence& e) { e.pixels.missing_model = 5000; }, Requirement::kOverlap,
         "mask and model do not cover each other: 0.16, wanted 0.55"},
        {[](Evidence& e) { e.alternatives_weight = 0.3, e.alternative = "half a turn about z"; },
         Requirement::kAlternatives,
         "another pose explains the image as well: half a turn about z, 0.30 of the probability, wanted 0.01 at most"},
        {[](Evidence& e) { e.alternatives_tried = false; }, Requirement::kAlternativesTried,
         "not yet compared with poses that look alike"},
        {[](Evidence& e) { e.frames_since_move = 2; }, Requirement::kStands,
         "image and arm contradict each other: the part was moved, or the set-up is at fault; 2 frames ago, wanted 5"},
        {[](Evidence& e) { e.motion_off_share = 2.0, e.motion_mistake = "as if it were inverted"; },
         Requirement::kArmMotion,
         "the image moves as if it were inverted: the arm's motion is off by 2.00 of itself, wanted 0.10 at most"},
        {[](Evidence& e) { e.setup_error_m = 0.006, e.setup_cause = "principal point"; }, Requirement::kSetup,
         "the part seems to move with the camera, by the principal point: up to 6.0 mm here, wanted 2.0 mm at most"},
        {[](Evidence& e) { e.covariance_about_centre(4, 4) = 0.002 * 0.002; }, Requirement::kTranslation,
         "precision: 5.0 mm along y, wanted 2.0 mm"},
        {[](Evidence& e) { e.covariance_about_centre(0, 0) = 0.02 * 0.02; }, Requirement::kRotation,
         "precision: 2.87 degrees about x, wanted 1.00 degrees"},
    };
    for (const Flaw& flaw : flaws) {
        Evidence evidence = flawless();
        flaw.make(evidence);
        const Judgement judgement = judge(evidence, Tolerance{}, Symmetries{});
        EXPECT_EQ(judgement.verdict, Verdict::kContinue) << flaw.text;
        ASSERT_EQ(judgement.missing.size(), 1U) << flaw.text;
        EXPECT_EQ(judgement.missing[0].requirement, flaw.requirement) << flaw.text;
        EXPECT_EQ(describe(judgement.missing[0]), flaw.text);
    }
}

TEST(Verdict, NothingIsMissingOfWhatIsAcceptedAndAllOfWhatIsNot) {
    EXPECT_TRUE(judge(flawless(), Tolerance{}, Symmetries{}).missing.empty());
    EXPECT_EQ(describe(judge(Evidence{}, Tolerance{}, Symmetries{}).missing.at(0)), "nothing of the object was found");
    Evidence evidence = flawless();
    evidence.pixels.contradicted = 150;
    evidence.alternatives_tried = false;
    EXPECT_EQ(judge(evidence, Tolerance{}, Symmetries{}).missing.size(), 2U);
}

// A sentence that says "0.93, wanted 0.93" explains nothing.
TEST(Verdict, SentencesTellTheFigureFromItsLimit) {
    EXPECT_EQ(describe({Requirement::kAgreement, 0.9284, 0.93, {}}), "too little agrees: 0.928, wanted 0.930");
    EXPECT_EQ(describe({Requirement::kNewImage, 4.0, 0.0, "12.0 mm"}),
              "the image has not changed for 4 frames while the camera moved by 12.0 mm");
    EXPECT_EQ(describe({Requirement::kTranslation, 0.00214, 0.00015, "x"}),
              "precision: 2.14 mm along x, wanted 0.15 mm");
    EXPECT_EQ(describe({Requirement::kRotation, 0.0174535, 0.0174533, "z"}),
              "precision: 1.00001 degrees about z, wanted 1.00000 degrees");
}

TEST(Verdict, RotationAboutAnAxisOfRevolutionDoesNotCount) {
    Evidence evidence = flawless();
    evidence.covariance_about_centre(2, 2) = 1.0;
    Symmetries shaft;
    shaft.continuous.push_back({Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()});
    EXPECT_EQ(judge(evidence, Tolerance{}, shaft).verdict, Verdict::kAccept);
    EXPECT_EQ(judge(evidence, Tolerance{}, Symmetries{}).verdict, Verdict::kContinue);
}

TEST(Verdict, AnImprecisePoseMayBeVerified) {
    Evidence evidence = flawless();
    evidence.covariance_about_centre = Matrix6d::Identity();
    EXPECT_TRUE(judge(evidence, Tolerance{}, Symmetries{}).verified);
    evidence.alternatives_weight = 0.3;
    EXPECT_FALSE(judge(evidence, Tolerance{}, Symmetries{}).verified);
}

TEST(Verdict, ToleranceIsTheUsers) {
    Evidence evidence = flawless();
    evidence.covariance_about_centre(4, 4) = 0.001 * 0.001;  // 90 % region: 2.5 mm
    EXPECT_EQ(judge(evidence, Tolerance{0.002, 0.0175}, Symmetries{}).verdict, Verdict::kContinue);
    EXPECT_EQ(judge(evidence, Tolerance{0.003, 0.0175}, Symmetries{}).verdict, Verdict::kAccept);
}

}  // namespace
}  // namespace nearpose
