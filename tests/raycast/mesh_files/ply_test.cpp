// PLY files: what is read, what is refused, and that nothing hangs, crashes or allocates by a header's word.
#include <cstring>
#include <limits>

#include "raycast/mesh_files/readers.hpp"
#include "raycast/mesh_loader.hpp"
#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

constexpr LengthUnit kUnit = LengthUnit::kMetre;

std::string header(const std::string& format, const std::string& elements) {
    return "ply\nformat " + format + " 1.0\ncomment a test\n" + elements + "end_header\n";
}

std::string cube_elements(int num_vertices, int num_faces) {
    return "element vertex " + std::to_string(num_vertices) +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(num_faces) +
           "\nproperty list uchar int vertex_indices\n";
}

// Six squares; the last line may be another.
std::string text_cube(const std::string& last_face = "4 1 3 7 5") {
    return header("ascii", cube_elements(8, 6)) +
           "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n4 0 1 3 2\n4 4 5 7 6\n4 0 1 5 4\n4 2 3 7 6\n"
           "4 0 2 6 4\n" +
           last_face + "\n";
}

template <typename T>
void put(std::string& bytes, T value, bool big_endian = false) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (big_endian) std::reverse(raw, raw + sizeof(T));
    bytes.append(raw, sizeof(T));
}

std::string binary_cube(bool big_endian = false) {
    std::string bytes = header(big_endian ? "binary_big_endian" : "binary_little_endian", cube_elements(8, 12));
    const Mesh box = make_box({0.5F, 0.5F, 0.5F});
    for (const Eigen::Vector3f& vertex : box.vertices_in_object) {
        for (int axis = 0; axis < 3; ++axis) put(bytes, vertex[axis], big_endian);
    }
    for (const auto& triangle : box.triangles) {
        put<std::uint8_t>(bytes, 3);
        for (int corner : triangle) put<std::int32_t>(bytes, corner, big_endian);
    }
    return bytes;
}

class Ply : public FolderTest {
  protected:
    LoadedMesh load(const std::string& bytes, const MeshLimits& limits = {}) const {
        return load_mesh(write("mesh.ply", bytes), kUnit, limits);
    }
    void expect_refused(const std::string& bytes, const std::string& part) const {
        expect_error<std::runtime_error>([&] { load(bytes); }, part);
        expect_error<std::runtime_error>([&] { load(bytes); }, "mesh.ply: ");
    }
};

TEST_F(Ply, ReadsTextAndBothByteOrders) {
    for (const std::string& bytes : {text_cube(), binary_cube(), binary_cube(true)}) {
        const LoadedMesh loaded = load(bytes);
        EXPECT_EQ(loaded.mesh.triangles.size(), 12U);
        EXPECT_EQ(loaded.mesh.vertices_in_object.size(), 8U);
        EXPECT_FALSE(loaded.mesh.is_cloud());
        EXPECT_NEAR(extent_of(loaded.mesh).diameter_m(), std::sqrt(3.0), 1e-6);
    }
}

TEST_F(Ply, ReadsEveryTypeAndSkipsWhatItDoesNotKnow) {
    for (const bool big_endian : {false, true}) {
        std::string bytes =
            header(big_endian ? "binary_big_endian" : "binary_little_endian",
                   "obj_info made by hand\nelement camera 2\nproperty list ushort double view\nproperty char id\n"
                   "element vertex 3\nproperty uchar red\nproperty float64 x\nproperty short y\nproperty list int "
                   "uint16 tags\n"
                   "property uint z\nelement face 1\nproperty int8 flag\nproperty list uint ushort vertex_index\n"
                   "property list uchar float texcoord\nelement end 1\nproperty float32 last\n");
        for (const int length : {0, 2}) {
            put<std::uint16_t>(bytes, static_cast<std::uint16_t>(length), big_endian);
            for (int i = 0; i < length; ++i) put<double>(bytes, 1.0, big_endian);
            put<std::int8_t>(bytes, 1);
        }
        for (int i = 0; i < 3; ++i) {
            put<std::uint8_t>(bytes, 255);
            put<double>(bytes, 1.5 * i, big_endian);
            put<std::int16_t>(bytes, static_cast<std::int16_t>(-i * i), big_endian);
            put<std::int32_t>(bytes, i, big_endian);
            for (int k = 0; k < i; ++k) put<std::uint16_t>(bytes, 9, big_endian);
            put<std::uint32_t>(bytes, 7, big_endian);
        }
        put<std::int8_t>(bytes, -1);
        put<std::uint32_t>(bytes, 3, big_endian);
        for (int i = 0; i < 3; ++i) put<std::uint16_t>(bytes, static_cast<std::uint16_t>(i), big_endian);
        put<std::uint8_t>(bytes, 1);
        put<float>(bytes, 0.5F, big_endian);
        put<float>(bytes, 0.5F, big_endian);
        const Mesh mesh = load(bytes).mesh;
        ASSERT_EQ(mesh.triangles.size(), 1U);
        EXPECT_EQ(mesh.vertices_in_object[2], Eigen::Vector3f(3.0F, -4.0F, 7.0F));
    }
}

TEST_F(Ply, AcceptsCarriageReturnsAndBlankLines) {
    std::string bytes;
    for (const char letter : text_cube()) bytes += letter == '\n' ? std::string("\r\n") : std::string(1, letter);
    EXPECT_EQ(load(bytes + "\r\n\r\n").mesh.triangles.size(), 12U);
}

TEST_F(Ply, RefusesBrokenHeaders) {
    expect_refused("ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\n", "no line \"end_header\"");
    expect_refused("ply", "end_header");
    expect_refused("plx\n", "does not begin");
    expect_refused("ply\nelement vertex 1\nproperty float x\nend_header\n", "no line \"format\"");
    expect_refused("ply\nformat ascii 2.0\nend_header\n", "version");
    expect_refused(header("ascii", "element vertex -1\n"), "count");
    expect_refused(header("ascii", "element vertex 99999999999999999999\n"), "count");
    expect_refused(header("ascii", "element vertex 1\nproperty float x\nproperty float x\n"), "second time");
    expect_refused(header("ascii", "element vertex 1\nproperty real x\n"), "unknown type");
    expect_refused(header("ascii", "element vertex 1\nproperty list float int x\n"), "integer type");
    expect_refused(header("ascii", "element vertex 1\n"), "no property");
    expect_refused(header("ascii", "elemnt vertex 1\n"), "unknown keyword");
    expect_refused(header("ascii", "property float x\n"), "before the first element");
    expect_refused(header("ascii", ""), "no vertices");
    expect_refused(
        header("ascii", "element vertex 1\nproperty float x\nproperty float y\nproperty float q\n") + "1 2 3\n",
        "no property \"z\"");
    std::string endless = "ply\nformat ascii 1.0\n";
    for (int i = 0; i < 100000; ++i) endless += "comment and so on\n";
    expect_refused(endless, "end_header");
}

TEST_F(Ply, RefusesCountsBeyondTheFileBeforeItAllocates) {
    for (const std::string format : {"ascii", "binary_little_endian"}) {
        expect_refused(header(format, cube_elements(1000000000, 1)), "cut short");
        expect_refused(header(format, cube_elements(3, 1000000000)) + std::string(36, ' '), "cut short");
    }
    // One face that claims 10^8 corners.
    std::string bytes =
        header("binary_little_endian",
               "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
               "property list int int vertex_indices\n");
    bytes.append(36, '\0');
    put<std::int32_t>(bytes, 100000000);
    bytes.append(100, '\0');
    expect_refused(bytes, "longer than the rest");
}

TEST_F(Ply, RefusesCutFilesAndFilesWithMore) {
    for (const std::string& whole : {text_cube(), binary_cube(), binary_cube(true)}) {
        const std::size_t body = whole.find("end_header\n") + 11;
        for (std::size_t cut = body; cut + 1 < whole.size(); cut += 3) {
            // A text file whose last number lost a digit or its newline alone is still whole.
            EXPECT_THROW(load(whole.substr(0, cut)), std::runtime_error) << cut << " of " << whole.size();
        }
        EXPECT_THROW(load(whole + "1"), std::runtime_error);
    }
}

TEST_F(Ply, CountsCornersThatDoNotExist) {
    for (const std::string corner : {"99", "-5", "4294967295", "8", "1.5", "nan", "1e400"}) {
        const LoadedMesh loaded = load(text_cube("3 0 1 " + corner));
        EXPECT_EQ(loaded.repair.triangles_bad_index, 1) << corner;
        EXPECT_EQ(loaded.mesh.triangles.size(), 10U);
    }
    std::string bytes = binary_cube();
    std::memset(bytes.data() + bytes.size() - 4, 0xFF, 4);
    EXPECT_EQ(load(bytes).repair.triangles_bad_index, 1);
}

TEST_F(Ply, CountsFacesOfTooFewCornersAndRefusesWrongLists) {
    for (const std::string face : {"0", "1 0", "2 0 1"})
        EXPECT_EQ(load(text_cube(face)).repair.triangles_degenerate, 1);
    expect_refused(text_cube("255 0 1 2"), "longer than the rest");
    expect_refused(text_cube("20 0 1 2"), "fewer values");
    expect_refused(text_cube("3 0 1"), "fewer values");
    expect_refused(text_cube("3 0 1 2 3"), "more values");
    expect_refused(text_cube("-3 0 1 2"), "length of a list");
    expect_refused(text_cube("1e18 0 1 2"), "longer than the rest");
    expect_refused(text_cube("3 0 1 x"), "not a number");
    expect_refused(header("ascii", cube_elements(3, 1)) + "0 0 0\n1 0 0\n0 1 0\n0\n", "none of the faces");
}

TEST_F(Ply, DropsAndCountsNumbersThatAreNotFinite) {
    for (const std::string word : {"nan", "inf", "-inf", "1e400"}) {
        std::string bytes = text_cube();
        bytes.replace(bytes.find("1 1 1\n"), 1, word);
        const LoadedMesh loaded = load(bytes);
        EXPECT_EQ(loaded.repair.vertices_not_finite, 1) << word;
        EXPECT_GT(loaded.repair.triangles_not_finite, 0);
        EXPECT_EQ(loaded.mesh.vertices_in_object.size(), 7U);
    }
}

TEST_F(Ply, KeepsToItsLimits) {
    MeshLimits limits;
    limits.max_triangles = 11;
    EXPECT_THROW(load(text_cube(), limits), std::runtime_error);
    limits.max_triangles = 12;
    EXPECT_NO_THROW(load(text_cube(), limits));
    limits.max_file_bytes = 100;
    expect_error<std::runtime_error>([&] { load(text_cube(), limits); }, "more than the limit of 100");
}

// Mutants either load, and then every index is in range, or throw.
TEST_F(Ply, MutantsLoadOrThrow) {
    std::mt19937 random(12345);
    int loaded = 0, refused = 0;
    for (const std::string& whole : {text_cube(), binary_cube()}) {
        for (int mutant = 0; mutant < 1000; ++mutant) {
            std::string bytes = whole;
            for (std::size_t edit = 0, count = 1 + random() % 8; edit < count && !bytes.empty(); ++edit) {
                const std::size_t place = random() % bytes.size();
                const std::size_t length = std::min<std::size_t>(1 + random() % 8, bytes.size() - place);
                switch (random() % 5) {
                    case 0:
                        bytes[place] = static_cast<char>(random());
                        break;
                    case 1:
                        bytes.erase(place, length);
                        break;
                    case 2:
                        bytes.insert(place, bytes.substr(place, length));
                        break;
                    case 3:
                        bytes.insert(place, "9999999999");
                        break;
                    default:
                        bytes[place] = static_cast<char>(bytes[place] ^ (1 << random() % 7));
                }
            }
            try {
                MeshRepair repair;
                const Mesh mesh = clean(read_ply(bytes, "mutant", {}, repair), "mutant", &repair);
                ++loaded;
                for (const auto& triangle : mesh.triangles) {
                    for (int corner : triangle) {
                        ASSERT_GE(corner, 0);
                        ASSERT_LT(static_cast<std::size_t>(corner), mesh.vertices_in_object.size());
                    }
                }
                for (const Eigen::Vector3f& vertex : mesh.vertices_in_object) ASSERT_TRUE(vertex.allFinite());
            } catch (const std::runtime_error&) {
                ++refused;
            }
        }
    }
    EXPECT_EQ(loaded + refused, 2000);
    EXPECT_GT(loaded, 50);
    EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace nearpose::test
