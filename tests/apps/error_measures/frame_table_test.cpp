#include <gtest/gtest.h>

#include <algorithm>

#include "apps/error_measures/frame_errors.hpp"
#include "tests/apps/support/test_files.hpp"

namespace nearpose::evaluation {
namespace {

using data_set::testing_files::expect_error;
using data_set::testing_files::new_folder;
using data_set::testing_files::write_text;

// One frame with everything, one without anything.
std::vector<FrameErrors> two_frames() {
    FrameErrors full;
    full.frame_id = 3;
    full.visibility = Visibility{0.4, 2e-6, 0.75};
    full.score = 0.9;
    full.time_s = 0.025;
    full.predicted = true;
    full.verdict = Verdict::kLost;
    full.shown = Shown::kNonsense;
    full.part_moved = true;
    full.errors.emplace();
    PoseErrors& errors = *full.errors;
    errors.translation_in_camera_m = {-0.001, 0.002, -0.0025};
    errors.rotation_in_camera_rad = {0.01, -0.02, 0.03};
    errors.translation_m = errors.translation_in_camera_m.norm();
    errors.rotation_rad = errors.rotation_in_camera_rad.norm();
    errors.add_m = 0.004;
    errors.add_s_m = 0.003;
    errors.mssd_m = 0.007;
    errors.mspd_px = 12.5;
    errors.mahalanobis_squared = 6.25;
    errors.mahalanobis_translation_squared = 2.5;
    FrameErrors empty;
    empty.frame_id = 4;
    return {full, empty};
}

TEST(FrameTable, GivesBackWhatWasWritten) {
    const std::string table = table_of(two_frames());
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3);
    const std::vector<FrameErrors> read = read_table(write_text(new_folder() / "table.csv", table));
    ASSERT_EQ(read.size(), 2U);
    EXPECT_EQ(table_of(read), table);
    const FrameErrors &full = read[0], written = two_frames()[0];
    EXPECT_TRUE(full.predicted);
    EXPECT_EQ(full.verdict, Verdict::kLost);
    EXPECT_EQ(full.shown, Shown::kNonsense);
    EXPECT_TRUE(full.part_moved);
    EXPECT_FALSE(read[1].verdict || read[1].part_moved);
    EXPECT_EQ(read[1].shown, Shown::kPart);
    EXPECT_NEAR(full.errors->rotation_rad, written.errors->rotation_rad, 1e-9);
    EXPECT_NEAR(full.errors->translation_in_camera_m.z(), -0.0025, 1e-11);
    EXPECT_DOUBLE_EQ(full.errors->mahalanobis_squared.value(), 6.25);
    EXPECT_FALSE(full.errors->mahalanobis_rotation_squared.has_value());
    EXPECT_NEAR(full.time_s, 0.025, 1e-12);
    EXPECT_NEAR(full.visibility->visible_volume_m3, 2e-6, 1e-17);
    EXPECT_DOUBLE_EQ(full.visibility->visible_fraction.value(), 0.75);
    EXPECT_FALSE(read[1].errors || read[1].visibility || read[1].predicted);
    EXPECT_LT(read[1].time_s, 0.0);
}

TEST(FrameTable, KnowsEveryVerdictAndWhatIsShown) {
    for (const Verdict verdict : {Verdict::kAccept, Verdict::kContinue, Verdict::kLost}) {
        for (const Shown shown : {Shown::kPart, Shown::kNothing, Shown::kNonsense}) {
            FrameErrors frame;
            frame.verdict = verdict;
            frame.shown = shown;
            const auto read = read_table(write_text(new_folder() / "table.csv", table_of({frame})));
            EXPECT_EQ(read.at(0).verdict, verdict);
            EXPECT_EQ(read.at(0).shown, shown);
        }
    }
}

TEST(FrameTable, TellsWhichVerdictsAreWrongWhereThereIsATolerance) {
    std::vector<FrameErrors> frames;
    for (const Verdict verdict : {Verdict::kAccept, Verdict::kContinue, Verdict::kLost}) {
        for (const double translation_m : {0.001, 0.003}) {
            FrameErrors& frame = frames.emplace_back();
            frame.verdict = verdict;
            frame.errors.emplace();
            frame.errors->translation_m = translation_m;
        }
    }
    frames.emplace_back();
    const std::string table = table_of(frames, Tolerance{0.002, 0.1});
    std::vector<std::string> last;
    for (std::size_t begin = 0, end = 0; begin < table.size(); begin = end + 1) {
        end = table.find('\n', begin);
        const std::string line = table.substr(begin, end - begin);
        last.push_back(line.substr(line.rfind(',') + 1));
    }
    EXPECT_EQ(last, (std::vector<std::string>{"verdict_error", "", "false_accept", "", "", "missed", "", ""}));
    const auto read = read_table(write_text(new_folder() / "table.csv", table));
    EXPECT_EQ(table_of(read), table_of(frames));  // all else is as without
    EXPECT_EQ(table_of(read, Tolerance{0.002, 0.1}), table);
}

TEST(FrameTable, OlderOnesHaveNoVerdicts) {
    std::string old;
    const std::string table = table_of(two_frames());
    for (std::size_t begin = 0, end = 0; begin < table.size(); begin = end + 1) {
        end = table.find('\n', begin);
        std::string line = table.substr(begin, end - begin);
        for (int column = 0; column < 3; ++column) line.resize(line.rfind(','));
        old += line + "\n";
    }
    const std::vector<FrameErrors> read = read_table(write_text(new_folder() / "table.csv", old));
    ASSERT_EQ(read.size(), 2U);
    EXPECT_DOUBLE_EQ(read[0].visibility->visible_fraction.value(), 0.75);
    EXPECT_FALSE(read[0].verdict.has_value());
    EXPECT_EQ(read[0].shown, Shown::kPart);
}

TEST(FrameTable, NoFramesAreATableToo) {
    EXPECT_TRUE(read_table(write_text(new_folder() / "table.csv", table_of({}))).empty());
}

TEST(FrameTable, SaysWhereItIsBroken) {
    const auto path = new_folder() / "table.csv";
    const std::string table = table_of(two_frames());
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = table;
        text.replace(text.find(from), from.size(), to);
        return text;
    };
    const auto expect = [&](const std::string& text, const std::vector<std::string>& parts) {
        write_text(path, text);
        std::vector<std::string> all = parts;
        all.push_back("table.csv");
        expect_error([&] { read_table(path); }, all);
    };
    expect("", {"empty"});
    expect("im_id,error\n1,2\n", {"line 1", "header"});
    expect(with("12.50000000", "much"), {"line 2", "mspd_px", "much"});
    expect(with("12.50000000", "nan"), {"line 2", "mspd_px"});
    expect(with("12.50000000", ""), {"line 2", "mspd_px", "is empty"});
    expect(with("3,1,", "3.5,1,"), {"line 2", "im_id", "3.5"});
    expect(with("3,1,", "3,2,"), {"line 2", "predicted"});
    expect(with("4,0,,,", "4,0,,7,"), {"line 3", "rotation_error_deg"});
    expect(with("lost,", "gone,"), {"line 2", "verdict", "gone", "accept, continue, lost"});
    expect(with("nonsense,", "sense,"), {"line 2", "shown", "part, nothing, nonsense"});
    expect(with("nonsense,1", "nonsense,2"), {"line 2", "part_moved", "0 or 1"});
    expect(table.substr(0, table.size() - 5), {"line 3", "columns"});
    expect_error([&] { read_table(path.parent_path() / "none.csv"); }, {"none.csv"});
}

}  // namespace
}  // namespace nearpose::evaluation
