// The phases of the filter: one table of transitions, and what each phase is worth.
#include "core/update/phase.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

namespace nearpose {
namespace {

// Never replaced for long, accepted, told from its alternatives.
Lock established() {
    Lock lock;
    lock.phase = Phase::kTracking;
    lock.verified = true;
    lock.alternatives_tried = 96;
    lock.frames_unreplaced = 100;
    lock.accepted_evidence = 50.0;
    return lock;
}

Lock changed(void (*change)(Lock&)) {
    Lock lock = established();
    change(lock);
    return lock;
}

struct Row {
    std::string when;
    Lock lock;
    bool has_particles;
    Phase expected;
};

TEST(Phase, FollowsFromTheRecordOfTheFramesBefore) {
    const auto same = [](Lock&) {};
    const std::vector<Row> table = {
        {"nothing is known", Lock{}, false, Phase::kSearching},
        {"nothing is known, whatever was", established(), false, Phase::kSearching},
        {"a pose was given or found, nothing is verified", Lock{}, true, Phase::kAcquiring},
        {"all is well", changed(same), true, Phase::kTracking},
        {"replaced a while ago", changed([](Lock& l) { l.frames_unreplaced = 5; }), true, Phase::kTracking},
        {"replaced just now, and verified", changed([](Lock& l) { l.frames_unreplaced = 4; }), true,
         Phase::kConfirming},
        {"replaced just now, and not verified", changed([](Lock& l) { l.frames_unreplaced = 4, l.verified = false; }),
         true, Phase::kAcquiring},
        {"an alternative is left", changed([](Lock& l) { l.alternatives_weight = 0.02; }), true, Phase::kComparing},
        {"an alternative is just not left", changed([](Lock& l) { l.alternatives_weight = 0.01; }), true,
         Phase::kTracking},
        {"an alternative is left of a pose that is not verified",
         changed([](Lock& l) { l.alternatives_weight = 0.02, l.verified = false; }), true, Phase::kComparing},
        {"an alternative is left of a pose found just now",
         changed([](Lock& l) { l.alternatives_weight = 0.02, l.verified = false, l.frames_unreplaced = 0; }), true,
         Phase::kAcquiring},
        {"contradicted by the image", changed([](Lock& l) { l.frames_contradicted = 1; }), true, Phase::kSearching},
        {"contradicted for long", changed([](Lock& l) { l.frames_contradicted = 7; }), true, Phase::kSearching},
        {"agrees too little, at first",
         changed([](Lock& l) { l.low_agreement = true, l.verified = false, l.frames_low_agreement = 4; }), true,
         Phase::kSearching},
        {"agrees too little, later", changed([](Lock& l) {
             l.low_agreement = true, l.verified = false, l.frames_low_agreement = 5, l.frames_unreplaced = 0;
         }),
         true, Phase::kAcquiring},
        {"agrees too little, later, and the track is confirmed",
         changed([](Lock& l) { l.low_agreement = true, l.verified = false, l.frames_low_agreement = 5; }), true,
         Phase::kTracking},
        {"agrees too little, now and then",
         changed([](Lock& l) { l.low_agreement = true, l.verified = false, l.frames_low_agreement = 32; }), true,
         Phase::kSearching},
    };
    for (const Row& row : table)
        EXPECT_STREQ(to_string(phase_of(row.lock, method_default(), row.has_particles)), to_string(row.expected))
            << row.when;
}

TEST(Phase, OnlyATrackIsSetBackByAnImageThatDisagreesWithItsPrediction) {
    for (const Phase phase :
         {Phase::kSearching, Phase::kAcquiring, Phase::kComparing, Phase::kConfirming, Phase::kTracking})
        EXPECT_EQ(phase_after_prediction(phase, true), phase);
    EXPECT_EQ(phase_after_prediction(Phase::kTracking, false), Phase::kConfirming);
    EXPECT_EQ(phase_after_prediction(Phase::kConfirming, false), Phase::kConfirming);
    EXPECT_EQ(phase_after_prediction(Phase::kAcquiring, false), Phase::kAcquiring);
}

TEST(Phase, WhatIsSwitchedOffIsNeverEntered) {
    Method method = method_default();
    method.effort.on = false;
    EXPECT_EQ(phase_of(established(), method, true), Phase::kAcquiring);
    method = method_default();
    method.relocalisation.low_agreement = false;
    Lock lock = after_assessment(established(), {Verdict::kContinue, false, 0.9, 0.0}, method);
    EXPECT_FALSE(search_due(lock, method));
    method.relocalisation.frames_contradicted = 0;
    lock.frames_contradicted = 3;
    EXPECT_FALSE(search_due(lock, method));
    lock.frames_contradicted = 1;
    EXPECT_FALSE(search_due(lock, method_paper())) << "the paper's filter never searches again";
}

TEST(Phase, EachIsWorthNoMoreThanTheOneBefore) {
    const Method method = method_default();
    const std::vector<Phase> phases = {Phase::kSearching, Phase::kAcquiring, Phase::kComparing, Phase::kConfirming,
                                       Phase::kTracking};
    for (std::size_t k = 1; k < phases.size(); ++k) {
        const Plan before = plan_of(phases[k - 1], method, false), after = plan_of(phases[k], method, false);
        EXPECT_LE(after.step.max_rays, before.step.max_rays);
        EXPECT_LE(after.refinement.max_rays, before.refinement.max_rays);
        EXPECT_LE(after.refinement.rounds, before.refinement.rounds);
        EXPECT_LE(after.alternatives, before.alternatives);
        EXPECT_EQ(after.step.rounds, method.step.rounds);
        EXPECT_EQ(plan_of(phases[k], method, true).step.rounds, method.effort.predicted_rounds);
    }
    EXPECT_EQ(plan_of(Phase::kAcquiring, method, false).refinement.max_rays, method.refinement.max_rays);
    EXPECT_EQ(plan_of(Phase::kConfirming, method, false).alternatives, method.hypotheses.alternatives);
    EXPECT_EQ(plan_of(Phase::kTracking, method, false).refinement.max_rays, method.effort.tracking.mode_rays);
}

TEST(Phase, NoPhaseAsksForMoreThanTheMethod) {
    Method method = method_default();
    method.step.max_rays = 10;
    method.step.rounds = 0;
    method.refinement.max_rays = 20;
    method.refinement.rounds = 1;
    method.hypotheses.alternatives = 2;
    const Plan plan = plan_of(Phase::kTracking, method, true);
    EXPECT_EQ(plan.step.max_rays, 10);
    EXPECT_EQ(plan.step.rounds, 0);
    EXPECT_EQ(plan.refinement.max_rays, 20);
    EXPECT_EQ(plan.refinement.rounds, 1);
    EXPECT_EQ(plan.alternatives, 2);
}

TEST(Lock, NewAlternativesAreDueInEveryFrameUntilTheTrackIsSettledAndThenPeriodically) {
    const Method method = method_default();
    const Lock undecided = changed([](Lock& l) { l.alternatives_weight = 0.4; });
    for (std::uint64_t step = 0; step < 30; ++step) {
        EXPECT_TRUE(alternatives_due(Lock{}, method, step));
        EXPECT_EQ(alternatives_due(established(), method, step), step % 10 == 0);
        EXPECT_EQ(alternatives_due(undecided, method, step), step % 10 == 0);
    }
}

TEST(Lock, KnownAlternativesAreComparedInEveryFrameWhileOneIsLeft) {
    const Method method = method_default();
    const Lock undecided = changed([](Lock& l) { l.alternatives_weight = 0.4; });
    for (std::uint64_t step = 0; step < 30; ++step) {
        EXPECT_TRUE(compares_alternatives(Lock{}, method, step));
        EXPECT_TRUE(compares_alternatives(undecided, method, step));
        EXPECT_EQ(compares_alternatives(established(), method, step), step % 10 == 0);
    }
}

TEST(Lock, ASearchIsWholeAtFirstAndSpreadOverFramesWhereNothingIsFoundForLong) {
    const RelocalisationOptions options = method_default().relocalisation;
    Lock lock;
    double searches = 0.0;
    for (int frame = 0; frame < options.whole_searches + options.parts_of_search; ++frame, ++lock.frames_contradicted)
        searches += search_share(lock, options);
    EXPECT_NEAR(searches, options.whole_searches + 1.0, 1e-9) << "the parts make one whole search";
    EXPECT_EQ(search_share(Lock{}, options), 1.0);
    EXPECT_LT(search_share(lock, options), 0.5);
}

TEST(Lock, AcceptedEvidenceFadesAndEndsWhereTheMotionIsNotKnown) {
    const Method method = method_default();
    EXPECT_DOUBLE_EQ(after_prediction(established(), true, method).accepted_evidence,
                     method.choice.accepted_evidence_kept * 50.0);
    EXPECT_EQ(after_prediction(established(), false, method).accepted_evidence, 0.0);
}

TEST(Lock, TheBeliefThatTheObjectIsThereIsABayesFilterThatForgets) {
    const Method method = method_default();
    Lock lock = after_assessment(
        Lock{}, {Verdict::kAccept, true, 1.0, 0.0, log_odds_with(8.0, Lock{}, method.presence)}, method);
    EXPECT_DOUBLE_EQ(lock.log_odds_present, 8.0);
    EXPECT_DOUBLE_EQ(after_prediction(lock, true, method).log_odds_present, method.presence.kept * 8.0);
    EXPECT_DOUBLE_EQ(after_prediction(lock, false, method).log_odds_present, method.presence.kept_unmeasured * 8.0);
    EXPECT_DOUBLE_EQ(log_odds_with(3.0, lock, method.presence), 11.0) << "evidence adds up";
    EXPECT_DOUBLE_EQ(log_odds_with(1e6, lock, method.presence), method.presence.max_log_odds);
    EXPECT_DOUBLE_EQ(log_odds_with(-1e6, lock, method.presence), -method.presence.max_log_odds)
        << "however long it was seen, it may be taken away";
    EXPECT_EQ(after_choice(lock, true, 0, std::nullopt).log_odds_present, 0.0) << "the evidence was for another pose";
}

TEST(Lock, AReplacementBeginsTheCountAnewAndAsksForAlternativesAgain) {
    const Lock replaced = after_choice(established(), true, 0, std::nullopt);
    EXPECT_EQ(replaced.frames_unreplaced, 0);
    EXPECT_EQ(replaced.alternatives_tried, 0);
    EXPECT_EQ(replaced.accepted_evidence, 0.0) << "it was for another pose";
    const Lock some = after_choice(replaced, false, 40, 0.3);
    EXPECT_EQ(some.frames_unreplaced, 1);
    EXPECT_EQ(some.alternatives_tried, 40);
    EXPECT_EQ(some.alternatives_weight, 0.3);
    const Lock more = after_choice(some, false, 60, std::nullopt);
    EXPECT_EQ(more.alternatives_tried, 100) << "a budget may spread them over several frames";
    EXPECT_EQ(more.alternatives_weight, 0.3) << "what was learned of them stays until they are compared again";
}

TEST(Lock, CountsWhatContradictsAndWhatIsUnverified) {
    const Method method = method_default();
    Lock lock = after_assessment(Lock{}, {Verdict::kLost, false, 0.0, 0.0}, method);
    EXPECT_EQ(lock.frames_contradicted, 1);
    EXPECT_EQ(lock.frames_low_agreement, 1);
    lock = after_assessment(lock, {Verdict::kContinue, false, 0.79, 0.0}, method);
    EXPECT_EQ(lock.frames_contradicted, 2);
    lock = after_assessment(lock, {Verdict::kContinue, false, 0.81, 9.0}, method);
    EXPECT_EQ(lock.frames_contradicted, 0) << "agrees in part";
    EXPECT_EQ(lock.frames_low_agreement, 3);
    EXPECT_TRUE(lock.low_agreement);
    EXPECT_EQ(lock.accepted_evidence, 0.0) << "was not accepted";
    lock = after_assessment(lock, {Verdict::kContinue, true, 0.95, 9.0}, method);
    EXPECT_FALSE(lock.low_agreement);
    EXPECT_EQ(lock.frames_low_agreement, 3) << "counts since the mode was replaced";
    lock = after_assessment(lock, {Verdict::kAccept, true, 0.95, 9.0}, method);
    EXPECT_EQ(lock.frames_low_agreement, 3) << "one that is accepted now and then is not searched for each time";
    EXPECT_EQ(after_choice(lock, true, 0, std::nullopt).frames_low_agreement, 0);
    EXPECT_EQ(lock.accepted_evidence, 9.0);
    lock = after_assessment(lock, {Verdict::kAccept, true, 0.95, 5.0}, method);
    EXPECT_EQ(lock.accepted_evidence, 9.0) << "more is not undone by less";
}

}  // namespace
}  // namespace nearpose
