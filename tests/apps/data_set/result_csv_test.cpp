#include "apps/data_set/result_csv.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "apps/base/text_split.hpp"
#include "tests/apps/support/test_files.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;
using namespace testing_files;

const std::string kHeader = "scene_id,im_id,obj_id,score,R,t,time\n";
const std::string kRow = "1,2,3,0.5,1 0 0 0 1 0 0 0 1,10 20 300,0.25\n";

PoseRow some_row() {
    PoseRow row;
    row.scene_id = 1;
    row.image_id = 12;
    row.object_id = 3;
    row.score = -1.5e-7;
    row.camera_from_object = exp((Twist() << 0.3, -1.2, 0.7, 0.01, -0.02, 0.31).finished());
    row.time_s = 0.123456789;
    return row;
}

TEST(ResultCsv, RowsComeBack) {
    const fs::path file = new_folder() / "nearpose_set-test.csv";
    PoseCsvWriter writer(file);
    EXPECT_EQ(read_text(file), kHeader);
    const PoseRow row = some_row();
    writer.append(row);
    PoseRow second = row;
    second.image_id = 13;
    writer.append(second);
    writer.close();
    const std::vector<PoseRow> rows = read_pose_csv(file);
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0].scene_id, 1);
    EXPECT_EQ(rows[1].image_id, 13);
    EXPECT_EQ(rows[0].object_id, 3);
    EXPECT_EQ(rows[0].score, row.score);
    EXPECT_EQ(rows[0].time_s, row.time_s);
    EXPECT_LT(log(rows[0].camera_from_object.inverse() * row.camera_from_object).norm(), 1e-14);
}

// What bop_toolkit splits and converts.
TEST(ResultCsv, RowsAreSevenFieldsAsTheToolkitReadsThem) {
    const fs::path file = new_folder() / "a.csv";
    PoseRow row = some_row();
    row.camera_from_object.rotation.coeffs() *= 1.01;  // drifted from unit length
    PoseCsvWriter(file).append(row);
    const std::string text = read_text(file);
    EXPECT_EQ(text.back(), '\n');
    EXPECT_EQ(text.find_first_of("\r\t[]\"+"), text.npos);
    const std::vector<std::string_view> rows = lines(text);
    ASSERT_EQ(rows.size(), 2U);
    const std::vector<std::string_view> fields = split(rows[1], ',');
    ASSERT_EQ(fields.size(), 7U);
    ASSERT_EQ(split(fields[4], ' ').size(), 9U);
    ASSERT_EQ(split(fields[5], ' ').size(), 3U);
    EXPECT_EQ(fields[1], "12");
    Eigen::Matrix3d R;
    for (int i = 0; i < 9; ++i)
        R(i / 3, i % 3) = std::stod(std::string(split(fields[4], ' ')[static_cast<std::size_t>(i)]));
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((R - some_row().camera_from_object.rotation_matrix()).cwiseAbs().maxCoeff(), 1e-14);
    // Millimetres.
    EXPECT_NEAR(std::stod(std::string(split(fields[5], ' ')[2])), 1e3 * row.camera_from_object.translation.z(), 1e-9);
}

TEST(ResultCsv, WhatIsNotFiniteIsNeverWritten) {
    const fs::path file = new_folder() / "a.csv";
    PoseCsvWriter writer(file);
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    PoseRow row = some_row();
    row.score = kNan;
    EXPECT_THROW(writer.append(row), std::invalid_argument);
    row = some_row();
    row.camera_from_object.rotation.x() = kNan;
    EXPECT_THROW(writer.append(row), std::invalid_argument);
    row = some_row();
    row.camera_from_object.rotation.coeffs().setZero();
    EXPECT_THROW(writer.append(row), std::invalid_argument);
    row = some_row();
    row.camera_from_object.translation.y() = std::numeric_limits<double>::infinity();
    EXPECT_THROW(writer.append(row), std::invalid_argument);
    EXPECT_EQ(read_text(file), kHeader);
}

TEST(ResultCsv, AFullDiskIsReported) {
    expect_error([] { PoseCsvWriter("/dev/full"); }, {"/dev/full", "No space left"});
}

TEST(ResultCsv, ReadsWhatTheToolkitReads) {
    const fs::path file = new_folder() / "a.csv";
    const std::string row = kRow.substr(0, kRow.size() - 1);
    for (const std::string& text : {kHeader + kRow, kRow, kHeader + row, kHeader + row + "\r\n",
                                    kHeader + "000001,000002,3,5e-1,1 0 0 0 1 0 0 0 1,1e1 20 3e2,-1\n"}) {
        write_text(file, text);
        const std::vector<PoseRow> rows = read_pose_csv(file);
        ASSERT_EQ(rows.size(), 1U) << text;
        EXPECT_EQ(rows[0].image_id, 2);
        EXPECT_DOUBLE_EQ(rows[0].camera_from_object.translation.z(), 0.3);
    }
}

TEST(ResultCsv, RefusesWhatTheToolkitRefuses) {
    const fs::path file = new_folder() / "a.csv";
    const auto refused = [&](const std::string& text, const std::vector<std::string>& parts) {
        write_text(file, text);
        expect_error([&] { read_pose_csv(file); }, parts);
    };
    refused("", {"a.csv", "no results"});
    refused(kHeader, {"a.csv", "no results"});
    refused(kHeader + kRow + "\n", {"line 3", "blank"});
    refused(kHeader + "\n" + kRow, {"line 2", "blank"});
    refused("# a comment\n" + kRow, {"line 1", "7"});
    refused("scene_id, im_id, obj_id, score, R, t, time\n" + kRow, {"line 1", "scene_id"});
    refused(kHeader + "1,2,3,0.5,1 0 0 0 1 0 0 0 1,10 20 300,0.25,8\n", {"line 2", "8 fields"});
    refused(kHeader + "1,2,3,0.5,1,0,0,0,1,0,0,0,1,10 20 300,0.25\n", {"line 2", "fields"});
    refused(kHeader + "1,2,3,0.5,[1 0 0 0 1 0 0 0 1],10 20 300,0.25\n", {"line 2", "R", "[1"});
    refused(kHeader + "1,2,3,0.5,1 0 0 0 1 0 0 0,10 20 300,0.25\n", {"line 2", "R has 8"});
    refused(kHeader + "1,2,3,0.5,1 0 0 0 1 0 0 0 1,10 20,0.25\n", {"line 2", "t has 2"});
    refused(kHeader + "1.0,2,3,0.5,1 0 0 0 1 0 0 0 1,10 20 300,0.25\n", {"line 2", "scene_id", "1.0"});
    refused(kHeader + "1,2,3,0.5,1 0 0 0 1 0 0 0 1,10 20 300,\n", {"line 2", "time"});
    refused(kHeader + kRow + "1,2,3,0.4,1 0 0 0 1 0 0 0 1,10 20 300,0.26\n", {"line 3", "time"});
    // The toolkit lets these pass and spoils its matching.
    refused(kHeader + "1,2,3,nan,1 0 0 0 1 0 0 0 1,10 20 300,0.25\n", {"line 2", "score", "nan"});
    refused(kHeader + "1,2,3,0.5,nan 0 0 0 1 0 0 0 1,10 20 300,0.25\n", {"line 2", "R", "nan"});
    refused(kHeader + "1,2,3,0.5,2 0 0 0 1 0 0 0 1,10 20 300,0.25\n", {"line 2", "not a rotation"});
}

TEST(ResultCsv, ADecimalCommaChangesNothing) {
    const CommaLocale locale;
    if (!locale.ok()) GTEST_SKIP() << "no locale with a decimal comma on this machine";
    const fs::path file = new_folder() / "a.csv";
    PoseCsvWriter(file).append(some_row());
    EXPECT_EQ(split(lines(read_text(file))[1], ',').size(), 7U);
    EXPECT_EQ(read_pose_csv(file)[0].time_s, 0.123456789);
}

TEST(ResultCsv, NamesThatTheToolkitCannotParseGetANotice) {
    for (const char* name :
         {"nearpose_tudl-test.csv", "near-pose_tudl-test-primesense_2.csv", "a/b_c/x_y-val_run_3.csv"}) {
        EXPECT_FALSE(bop_file_name_notice(name)) << name;
    }
    for (const char* not_meant_for_it : {"-", "poses.csv", "a_b/nearpose_tudl.csv"}) {
        EXPECT_FALSE(bop_file_name_notice(not_meant_for_it)) << not_meant_for_it;
    }
    for (const char* name : {"near_pose_tudl-test.csv", "nearpose_my_set-test.csv", "nearpose_x.5_tudl-test.csv",
                             "nearpose_tudl-test.txt", "_tudl-test.csv", "nearpose_-test.csv"}) {
        const std::optional<std::string> notice = bop_file_name_notice(name, "my_set-1.5");
        ASSERT_TRUE(notice) << name;
        EXPECT_NE(notice->find(fs::path(name).filename().string()), notice->npos);
        EXPECT_NE(notice->find("nearpose_myset15-test.csv"), notice->npos);
    }
    EXPECT_FALSE(bop_file_name_notice("nearpose_myset15-test.csv"));  // what is proposed is good
}

}  // namespace
}  // namespace nearpose::data_set
