#include "apps/data_set/point_cloud_file.hpp"

#include <gtest/gtest.h>
#include <liblzf/lzf.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "tests/apps/support/test_files.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;
using namespace testing_files;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

template <typename Number>
std::string raw(Number value, bool reversed = false) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return reversed ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

std::string pcd_header(int width, int height, const std::string& data) {
    return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS rgb y _ x z\nSIZE 4 4 1 8 4\nTYPE U F U F "
           "F\n"
           "COUNT 1 1 3 1 1\nWIDTH " +
           std::to_string(width) + "\nHEIGHT " + std::to_string(height) + "\nVIEWPOINT 1 2 3 0 1 0 0\nPOINTS " +
           std::to_string(width * height) + "\nDATA " + data + "\n";
}

// The points of the fields above: x is a double, y and z floats, among others.
std::string pcd_record(const Eigen::Vector3f& p) {
    return raw<std::uint32_t>(7) + raw(p.y()) + "abc" + raw<double>(p.x()) + raw(p.z());
}

std::string pcd_columns(const std::vector<Eigen::Vector3f>& points) {
    std::string colours, ys, pads, xs, zs;
    for (const Eigen::Vector3f& p : points) {
        colours += raw<std::uint32_t>(7);
        ys += raw(p.y());
        pads += "abc";
        xs += raw<double>(p.x());
        zs += raw(p.z());
    }
    return colours + ys + pads + xs + zs;
}

std::string compressed(const std::string& bytes) {
    std::string packed(bytes.size() * 2 + 100, '\0');
    packed.resize(lzf_compress(bytes.data(), static_cast<unsigned>(bytes.size()), packed.data(),
                               static_cast<unsigned>(packed.size())));
    return raw(static_cast<std::uint32_t>(packed.size())) + raw(static_cast<std::uint32_t>(bytes.size())) + packed;
}

const std::vector<Eigen::Vector3f> kPoints = {{0.1F, 0.2F, 0.3F}, {kNan, kNan, kNan}, {-0.5F, 0.25F, 1.5F}, {0, 0, 0}};

std::string file_of(const std::vector<Eigen::Vector3f>& points, int width, int height, const std::string& data) {
    std::string text = pcd_header(width, height, data);
    if (data == "binary_compressed") return text + compressed(pcd_columns(points));
    for (const Eigen::Vector3f& p : points) {
        if (data == "binary") text += pcd_record(p);
        if (data != "ascii") continue;
        const auto number = [](float value) { return std::isnan(value) ? std::string("nan") : std::to_string(value); };
        text += "7 " + number(p.y()) + " 97 98 99 " + number(p.x()) + " " + number(p.z()) + "\n";
    }
    return text;
}

class Pcd : public testing::TestWithParam<std::string> {};

TEST_P(Pcd, OrganisedCloudsKeepTheirGrid) {
    const fs::path file = write_text(new_folder() / "a.pcd", file_of(kPoints, 2, 2, GetParam()));
    const CloudFile cloud = read_cloud(file);
    EXPECT_EQ(cloud.width, 2);
    EXPECT_EQ(cloud.height, 2);
    EXPECT_TRUE(cloud.organised());
    ASSERT_EQ(cloud.points_in_camera.size(), 4U);
    EXPECT_EQ(cloud.points_in_camera[0], kPoints[0]);
    EXPECT_TRUE(std::isnan(cloud.points_in_camera[1].x()));
    EXPECT_EQ(cloud.points_in_camera[2], kPoints[2]);
    EXPECT_TRUE(std::isnan(cloud.points_in_camera[3].z()));  // the origin is no measurement
}

TEST_P(Pcd, OthersKeepFinitePointsOnly) {
    const CloudFile cloud = read_cloud(write_text(new_folder() / "a.pcd", file_of(kPoints, 4, 1, GetParam())));
    EXPECT_EQ(cloud.width, 2);
    EXPECT_EQ(cloud.points_in_camera, (std::vector<Eigen::Vector3f>{kPoints[0], kPoints[2]}));
}

TEST_P(Pcd, CutFilesAreRefused) {
    const fs::path folder = new_folder();
    const std::string whole = file_of(std::vector<Eigen::Vector3f>(50, kPoints[0]), 50, 1, GetParam());
    // The last bytes of a text may be a line end and digits of the last number.
    for (std::size_t length = 0; length + 4 < whole.size(); length += 11) {
        write_text(folder / "cut.pcd", whole.substr(0, length));
        if (GetParam() == "ascii" && length + 20 > whole.size()) continue;
        expect_error([&] { read_cloud(folder / "cut.pcd"); }, {"cut.pcd"});
    }
}

TEST_P(Pcd, DamagedFilesNeverCrash) {
    const fs::path folder = new_folder();
    const std::string whole = file_of(std::vector<Eigen::Vector3f>(40, kPoints[0]), 8, 5, GetParam());
    std::mt19937 random(1);
    int refused = 0;
    for (int trial = 0; trial < 150; ++trial) {
        std::string damaged = whole;
        for (int edit = 0; edit < 3; ++edit) damaged[random() % damaged.size()] = static_cast<char>(random());
        write_text(folder / "damaged.pcd", damaged);
        try {
            const CloudFile cloud = read_cloud(folder / "damaged.pcd");
            EXPECT_EQ(cloud.points_in_camera.size(), static_cast<std::size_t>(cloud.width) * cloud.height);
        } catch (const std::runtime_error&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 0);
}

INSTANTIATE_TEST_SUITE_P(Encodings, Pcd, testing::Values("ascii", "binary", "binary_compressed"),
                         [](const auto& instance) { return instance.param; });

TEST(PcdFile, FalseHeadersAreRefusedBeforeAnythingIsAllocated) {
    const fs::path file = new_folder() / "a.pcd";
    const auto refused = [&](const std::string& from, const std::string& to, const std::vector<std::string>& parts) {
        std::string text = file_of(kPoints, 2, 2, "binary");
        const std::size_t at = text.find(from);
        ASSERT_NE(at, text.npos);
        write_text(file, text.replace(at, from.size(), to));
        expect_error([&] { read_cloud(file); }, parts);
    };
    refused("WIDTH 2", "WIDTH 2000000000", {"a.pcd", "WIDTH"});
    refused("WIDTH 2\nHEIGHT 2\n", "WIDTH 90000000\nHEIGHT 90000000\n", {"a.pcd", "too many points"});
    refused("WIDTH 2\nHEIGHT 2\nVIEWPOINT 1 2 3 0 1 0 0\nPOINTS 4", "WIDTH 90000000\nHEIGHT 1\nPOINTS 90000000",
            {"a.pcd", "cut short"});
    refused("WIDTH 2", "WIDTH -2", {"a.pcd", "WIDTH"});
    refused("POINTS 4", "POINTS 5", {"a.pcd", "POINTS"});
    refused("x z", "x w", {"a.pcd", "x, y and z"});
    refused("x z", "x x", {"a.pcd", "x stands twice"});
    refused("TYPE U F U F F", "TYPE U F U I F", {"a.pcd", "x must be"});
    refused("COUNT 1 1 3 1 1", "COUNT 1 1 3 1", {"a.pcd", "differ in number"});
    refused("COUNT 1 1 3", "COUNT 1 1 999999", {"a.pcd", "COUNT"});
    refused("DATA binary", "DATA magic", {"a.pcd", "magic"});
    refused("HEIGHT 2\n", "", {"a.pcd", "HEIGHT"});
}

TEST(PcdFile, AFalseUnpackedSizeIsRefused) {
    const std::string header = pcd_header(40'000'000, 1, "binary_compressed");
    const std::uint32_t claimed = 40'000'000U * 23U;
    const fs::path file =
        write_text(new_folder() / "a.pcd", header + raw<std::uint32_t>(8) + raw(claimed) + "12345678");
    expect_error([&] { read_cloud(file); }, {"a.pcd", "size of the points"});
}

std::string ply_header(const std::string& format, int count) {
    return "ply\nformat " + format + " 1.0\ncomment by hand\nelement vertex " + std::to_string(count) +
           "\nproperty uchar red\nproperty double z\nproperty float x\nproperty float32 y\nelement face 0\n"
           "property list uchar int vertex_indices\nend_header\n";
}

TEST(PlyCloud, AllThreeFormats) {
    const fs::path folder = new_folder();
    const Eigen::Vector3f point(0.5F, -0.25F, 0.125F);
    for (const bool reversed : {false, true}) {
        const std::string format = reversed ? "binary_big_endian" : "binary_little_endian";
        const std::string data =
            "r" + raw<double>(point.z(), reversed) + raw(point.x(), reversed) + raw(point.y(), reversed);
        const CloudFile cloud = read_cloud(write_text(folder / "b.ply", ply_header(format, 2) + data + data));
        EXPECT_EQ(cloud.points_in_camera, (std::vector<Eigen::Vector3f>{point, point}));
        expect_error([&] { read_cloud(write_text(folder / "c.ply", ply_header(format, 3) + data + data)); },
                     {"c.ply", "cut"});
    }
    const std::string text = ply_header("ascii", 2) + "255 0.125 0.5 -0.25\n0 nan nan nan\n";
    EXPECT_EQ(read_cloud(write_text(folder / "a.ply", text)).points_in_camera, (std::vector<Eigen::Vector3f>{point}));
}

// Millimetres of integers are no metres, but a cloud of them is one.
TEST(PlyCloud, CoordinatesMayBeWholeNumbers) {
    const fs::path file = new_folder() / "a.ply";
    const std::string header =
        " 1.0\nelement vertex 2\nproperty short x\nproperty uchar y\nproperty int z\nend_header\n";
    const std::vector<Eigen::Vector3f> points = {{-2.0F, 200.0F, 3.0F}, {1.0F, 0.0F, 70000.0F}};
    write_text(file, "ply\nformat ascii" + header + "-2 200 3\n1 0 70000\n");
    EXPECT_EQ(read_cloud(file).points_in_camera, points);
    write_text(file, "ply\nformat binary_big_endian" + header + raw<std::int16_t>(-2, true) + '\xc8' +
                         raw<std::int32_t>(3, true) + raw<std::int16_t>(1, true) + '\0' +
                         raw<std::int32_t>(70000, true));
    EXPECT_EQ(read_cloud(file).points_in_camera, points);
}

TEST(PlyCloud, VerticesMayHaveLists) {
    const fs::path file = new_folder() / "a.ply";
    const std::string header =
        " 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
        "property list uchar short seen_by\nproperty uchar red\nend_header\n";
    const std::vector<Eigen::Vector3f> points = {{1.0F, 2.0F, 3.0F}, {4.0F, 5.0F, 6.0F}};
    write_text(file, "ply\nformat ascii" + header + "1 2 3 2 7 8 255\n4 5 6 0 255\n");
    EXPECT_EQ(read_cloud(file).points_in_camera, points);
    const auto xyz = [](float x, float y, float z) { return raw(x, false) + raw(y, false) + raw(z, false); };
    const std::string data = xyz(1, 2, 3) + '\2' + std::string(4, 'n') + 'r' + xyz(4, 5, 6) + '\0' + 'r';
    write_text(file, "ply\nformat binary_little_endian" + header + data);
    EXPECT_EQ(read_cloud(file).points_in_camera, points);
    for (std::size_t length = 0; length < data.size(); ++length) {
        write_text(file, "ply\nformat binary_little_endian" + header + data.substr(0, length));
        expect_error([&] { read_cloud(file); }, {"a.ply", "cut short"});
    }
}

TEST(PcdFile, OldHeadersAreUnderstood) {
    const fs::path file = new_folder() / "a.PCD";
    const std::vector<Eigen::Vector3f> points = {{1.0F, 2.0F, 3.0F}, {4.0F, 5.0F, 6.0F}};
    for (const char* header :
         {"VERSION .6\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n",
          "VERSION .5\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\n", "COLUMNS x y z\nPOINTS 2\n"}) {
        write_text(file, std::string(header) + "DATA ascii\n1 2 3\n4 5 6\n");
        EXPECT_EQ(read_cloud(file).points_in_camera, points) << header;
    }
}

TEST(TextCloud, HasAPointALine) {
    const fs::path folder = new_folder();
    const std::vector<Eigen::Vector3f> points = {{1.0F, 2.0F, 3.0F}, {4.0F, 5.0F, 6.5F}};
    for (const char* text : {"1 2 3\n4 5 6.5\n", "2\n1 2 3 255 0 0\n4 5 6.5 1 1 1\n",
                             "# by hand\nx,y,z\n1,2,3\n4,5,6.5", "1;2;3;9\r\n\r\n4;5;6.5;9\r\n"}) {
        for (const char* name : {"a.xyz", "a.pts", "a.XYZ"}) {
            EXPECT_EQ(read_cloud(write_text(folder / name, text)).points_in_camera, points) << text;
        }
    }
    expect_error([&] { read_cloud(write_text(folder / "b.xyz", "1 2 3\nx y z\n")); }, {"b.xyz", "line 2"});
    expect_error([&] { read_cloud(write_text(folder / "b.xyz", "1 2 3\n4 5\n")); }, {"b.xyz", "line 2"});
    EXPECT_TRUE(read_cloud(write_text(folder / "c.xyz", "")).points_in_camera.empty());
}

TEST(PlyCloud, BadFilesAreRefused) {
    const fs::path file = new_folder() / "a.ply";
    const auto refused = [&](const std::string& text, const std::vector<std::string>& parts) {
        write_text(file, text);
        expect_error([&] { read_cloud(file); }, parts);
    };
    refused("", {"a.ply", "header"});
    refused("ply\nformat ascii 1.0\nelement vertex 3\n", {"a.ply", "header does not end"});
    refused("solid\n", {"a.ply", "not a PLY"});
    refused("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", {"a.ply", "x, y and z"});
    refused("ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nend_header\n1\n", {"a.ply", "x, y and z"});
    refused("ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int n\nproperty float x\nend_header\n",
            {"a.ply", "list stands before"});
    refused(ply_header("ascii", 90'000'000) + "1 1 1 1\n", {"a.ply", "cut short"});
    refused(ply_header("ascii", 1) + "1 1 1\n", {"a.ply", "point 0"});
    refused(ply_header("ascii", 1) + "1 1 1 one\n", {"a.ply", "point 0", "one"});
    refused("ply\nformat ascii 1.0\nelement vertex 999999999999\n", {"a.ply", "999999999999"});
}

TEST(Clouds, AreListedByNumber) {
    const fs::path folder = new_folder();
    expect_error([&] { list_clouds(folder); }, {folder.string(), "no .pcd, .ply"});
    for (const char* name : {"cloud_10.pcd", "cloud_9.pcd", "cloud_009.ply", "cloud_1.pcd", "notes.txt"}) {
        write_text(folder / name, "");
    }
    const std::vector<fs::path> clouds = list_clouds(folder);
    std::vector<std::string> names;
    for (const fs::path& cloud : clouds) names.push_back(cloud.filename().string());
    EXPECT_EQ(names, (std::vector<std::string>{"cloud_1.pcd", "cloud_9.pcd", "cloud_009.ply", "cloud_10.pcd"}));
    expect_error([&] { read_cloud(folder / "notes.txt"); }, {"notes.txt", "is no .pcd"});
    expect_error([&] { list_clouds(folder / "none"); }, {"none"});
}

TEST(Clouds, TheOrderOfNamesIsStrict) {
    const std::vector<std::string> names = {"", "1", "01", "2", "10", "a", "a1", "a1b", "a01b", "a2", "a10", "b"};
    for (std::size_t i = 0; i < names.size(); ++i) {
        for (std::size_t j = 0; j < names.size(); ++j) {
            EXPECT_EQ(numeric_less(names[i], names[j]), i < j) << names[i] << " " << names[j];
        }
    }
}

}  // namespace
}  // namespace nearpose::data_set
