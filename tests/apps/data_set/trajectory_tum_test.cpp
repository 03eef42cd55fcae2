#include "apps/data_set/trajectory_tum.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "apps/base/text_split.hpp"
#include "tests/apps/support/test_files.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;
using namespace testing_files;

const std::string kRow = "1.5 0.1 0.2 0.3 0 0 0 1\n";

Pose some_pose() {
    return exp((Twist() << 0.3, -1.2, 2.2, 0.01, -0.02, 0.31).finished());
}

TEST(TrajectoryTum, RowsComeBack) {
    const fs::path file = new_folder() / "poses.tum";
    TumWriter writer(file);
    writer.append(1305031098.6659, some_pose());
    writer.append(1305031098.6660, some_pose().inverse());
    writer.close();
    const std::vector<StampedPose> rows = read_tum(file);
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0].stamp_s, 1305031098.6659);
    EXPECT_LT(log(rows[0].pose.inverse() * some_pose()).norm(), 1e-8);  // 9 decimals
    EXPECT_LT(log(rows[1].pose * some_pose()).norm(), 1e-8);
}

TEST(TrajectoryTum, RowsAreAsEvoReadsThem) {
    const fs::path file = new_folder() / "poses.tum";
    TumWriter writer(file);
    Pose pose;
    pose.rotation = Eigen::Quaterniond(-0.8, 0.6, 0.0, -0.0);  // w < 0
    pose.translation = {1.0, -0.5, -1e-12};
    writer.append(0.1, pose);
    EXPECT_EQ(read_text(file),
              "0.100000000 1.000000000 -0.500000000 0.000000000 -0.600000000 0.000000000 0.000000000 0.800000000\n");
}

TEST(TrajectoryTum, StampsMustGrow) {
    TumWriter writer(new_folder() / "poses.tum");
    writer.append(1.0, {});
    EXPECT_THROW(writer.append(1.0, {}), std::invalid_argument);
    EXPECT_THROW(writer.append(1.0 + 1e-10, {}), std::invalid_argument);  // the same text
    EXPECT_THROW(writer.append(0.5, {}), std::invalid_argument);
    writer.append(1.000000001, {});
}

TEST(TrajectoryTum, WhatIsNotFiniteIsNeverWritten) {
    const fs::path file = new_folder() / "poses.tum";
    TumWriter writer(file);
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(writer.append(kNan, {}), std::invalid_argument);
    Pose pose;
    pose.translation.x() = kNan;
    EXPECT_THROW(writer.append(1.0, pose), std::invalid_argument);
    pose = {};
    pose.rotation.w() = kNan;
    EXPECT_THROW(writer.append(1.0, pose), std::invalid_argument);
    pose.rotation.coeffs().setZero();
    EXPECT_THROW(writer.append(1.0, pose), std::invalid_argument);
    EXPECT_EQ(read_text(file), "");
    expect_error([] { TumWriter("/dev/full").append(1.0, {}); }, {"/dev/full", "No space left"});
}

TEST(TrajectoryTum, FramesAreNamed) {
    const Pose camera_from_object = some_pose();
    const Pose camera_from_world = exp((Twist() << -0.5, 0.1, 0.4, 1.0, 2.0, 3.0).finished());
    const Eigen::Vector3d point_in_object(0.1, 0.2, 0.3);
    const Eigen::Vector3d point_in_camera = camera_from_object * point_in_object;
    const auto pose = [&](const std::string& name) {
        return *trajectory_pose(trajectory_frame_of(name), camera_from_object, camera_from_world);
    };
    EXPECT_LT((pose("camera") * point_in_object - point_in_camera).norm(), 1e-14);
    EXPECT_LT((pose("object") * point_in_camera - point_in_object).norm(), 1e-14);
    EXPECT_LT((camera_from_world * (pose("world") * point_in_object) - point_in_camera).norm(), 1e-14);
    EXPECT_FALSE(trajectory_pose(TrajectoryFrame::kWorld, camera_from_object, std::nullopt));
    EXPECT_THROW(trajectory_frame_of("base"), std::invalid_argument);
}

TEST(TrajectoryTum, ReadsWhatEvoReads) {
    const fs::path file = new_folder() / "a.tum";
    for (const std::string& text :
         {kRow, "# header\n" + kRow, kRow.substr(0, kRow.size() - 1), std::string("1.5e0 0.1 0.2 0.3 0 0 0 1\r\n")}) {
        write_text(file, text);
        ASSERT_EQ(read_tum(file).size(), 1U) << text;
        EXPECT_EQ(read_tum(file)[0].stamp_s, 1.5);
    }
}

TEST(TrajectoryTum, RefusesWhatEvoRefuses) {
    const fs::path file = new_folder() / "a.tum";
    const auto refused = [&](const std::string& text, const std::vector<std::string>& parts) {
        write_text(file, text);
        expect_error([&] { read_tum(file); }, parts);
    };
    refused("", {"a.tum", "no poses"});
    refused("# only a header\n", {"a.tum", "no poses"});
    refused("timestamp tx ty tz qx qy qz qw\n" + kRow, {"line 1", "timestamp"});
    refused(" # indented\n" + kRow, {"line 1"});
    refused(kRow + "\n", {"line 2"});
    refused("1.5  0.1 0.2 0.3 0 0 0 1\n", {"line 1", "9 fields"});
    refused("1.5\t0.1 0.2 0.3 0 0 0 1\n", {"line 1"});
    refused("1.5,0.1,0.2,0.3,0,0,0,1\n", {"line 1"});
    refused("1.5 0.1 0.2 0.3 0 0 0 1 \n", {"line 1", "9 fields"});
    refused("1.5 0.1 0.2 0.3 0 0 0 1 2\n", {"line 1", "9 fields"});
    refused("1.5 0.1 0.2 0.3 0 0 0\n", {"line 1", "7 fields"});
    refused("1.5 nan 0.2 0.3 0 0 0 1\n", {"line 1", "nan"});
    refused("1.5 0.1 0.2 0.3 0 0 0 0.9999\n", {"line 1", "length"});
    refused(kRow + kRow, {"line 2", "not later"});
    refused("2.5 0 0 0 0 0 0 1\n" + kRow, {"line 2", "not later"});
    write_text(file, "1.5 0.1 0.2 0.3 0 0 0 0.9999\n");
    EXPECT_EQ(read_tum(file, 1e-3)[0].pose.rotation.w(), 1.0);
}

TEST(TrajectoryTum, ADecimalCommaChangesNothing) {
    const CommaLocale locale;
    if (!locale.ok()) GTEST_SKIP() << "no locale with a decimal comma on this machine";
    const fs::path file = new_folder() / "a.tum";
    TumWriter(file).append(0.5, {});
    EXPECT_EQ(read_text(file).find(','), std::string::npos);
    EXPECT_EQ(read_tum(file)[0].stamp_s, 0.5);
}

}  // namespace
}  // namespace nearpose::data_set
