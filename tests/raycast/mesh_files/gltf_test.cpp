// glTF and GLB: the guard before the importer, and the importer behind it.
#include <sys/stat.h>

#include <cstring>

#include "raycast/mesh_loader.hpp"
#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

constexpr LengthUnit kUnit = LengthUnit::kMetre;

// The positions and 16-bit indices of a unit cube: 96 + 72 bytes.
std::string cube_buffer() {
    std::string bytes;
    const Mesh box = make_box({0.5F, 0.5F, 0.5F});
    for (const Eigen::Vector3f& vertex : box.vertices_in_object) {
        bytes.append(reinterpret_cast<const char*>(vertex.data()), 12);
    }
    for (const auto& triangle : box.triangles) {
        for (int corner : triangle) {
            const auto index = static_cast<std::uint16_t>(corner);
            bytes.append(reinterpret_cast<const char*>(&index), 2);
        }
    }
    return bytes;
}

struct Parts {
    std::string uri = R"(,"uri":"cube.bin")";
    std::string nodes = R"([{"mesh":0,"name":"n"}])";
    std::string roots = "[0]";
    std::string primitive = R"({"attributes":{"POSITION":0},"indices":1,"material":0})";
    std::string count = "36";
    std::string view_bytes = "72";
    std::string buffer_bytes = "168";
    std::string more;
};

std::string gltf(const Parts& parts) {
    return R"({"asset":{"version":"2.0","generator":"\"test\""},"scene":0,"scenes":[{"nodes":)" + parts.roots +
           R"(}],"nodes":)" + parts.nodes + R"(,"meshes":[{"primitives":[)" + parts.primitive +
           R"(]}],"accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[0,0,0]},)" +
           R"({"bufferView":1,"componentType":5123,"count":)" + parts.count + R"(,"type":"SCALAR"}],)" +
           R"("bufferViews":[{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":)" +
           parts.view_bytes + R"(}],"buffers":[{"byteLength":)" + parts.buffer_bytes + parts.uri + "}]" + parts.more +
           R"(,"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":77}}}]})";
}

std::string glb(std::string json, const std::string& binary) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto number = [](std::size_t value) {
        const auto small = static_cast<std::uint32_t>(value);
        return std::string(reinterpret_cast<const char*>(&small), 4);
    };
    return "glTF" + number(2) + number(28 + json.size() + binary.size()) + number(json.size()) + "JSON" + json +
           number(binary.size()) + std::string("BIN\0", 4) + binary;
}

class Gltf : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        write("cube.bin", cube_buffer());
    }
    LoadedMesh load(const Parts& parts) const { return load_mesh(write("cube.gltf", gltf(parts)), kUnit); }
    void expect_refused(const Parts& parts, const std::string& part) const {
        expect_error<std::runtime_error>([&] { load(parts); }, part);
        expect_error<std::runtime_error>([&] { load(parts); }, "cube.gltf: ");
    }
};

TEST_F(Gltf, ReadsBuffersBesideWithinAndInTheFile) {
    Parts within;
    within.uri = R"(,"uri":"data:application/octet-stream;base64,)";
    const std::string bytes = cube_buffer();  // of a length that three divides
    constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        unsigned group = 0;
        for (std::size_t k = 0; k < 3; ++k) group = group << 8U | static_cast<unsigned char>(bytes[i + k]);
        for (int shift = 18; shift >= 0; shift -= 6) within.uri += kLetters[group >> shift & 63U];
    }
    within.uri += "\"";
    Parts chunk;
    chunk.uri = "";
    Parts long_type = within;
    long_type.uri.insert(long_type.uri.find("stream"), std::string(100, 'z'));
    write("beside.gltf", gltf({}));
    write("within.gltf", gltf(within));
    write("long_type.gltf", gltf(long_type));
    write("chunk.GLB", glb(gltf(chunk), cube_buffer()));
    for (const std::string name : {"beside.gltf", "within.gltf", "long_type.gltf", "chunk.GLB"}) {
        const LoadedMesh loaded = load_mesh(folder_ / name, kUnit);
        EXPECT_EQ(loaded.mesh.triangles.size(), 12U) << name;
        EXPECT_EQ(loaded.mesh.vertices_in_object.size(), 8U) << name;
        EXPECT_NEAR(extent_of(loaded.mesh).diameter_m(), std::sqrt(3.0), 1e-6) << name;
    }
}

TEST_F(Gltf, PlacesNodesByTheirTransforms) {
    Parts parts;
    // A parent moved by 2 m along x with two children: one as it is, one turned by 90 degrees about z and moved by y
    // = 3.
    parts.nodes = R"([{"translation":[2,0,0],"children":[1,2]},{"mesh":0},
        {"mesh":0,"translation":[0,3,0],"rotation":[0,0,0.70710678,0.70710678],"scale":[2,1,1]}])";
    const Mesh mesh = load(parts).mesh;
    EXPECT_EQ(mesh.triangles.size(), 24U);
    const ModelExtent extent = extent_of(mesh);
    EXPECT_LT((extent.box_min_in_object - Eigen::Vector3d(1.5, -0.5, -0.5)).norm(), 1e-5);
    EXPECT_LT((extent.box_max_in_object - Eigen::Vector3d(2.5, 4.0, 0.5)).norm(), 1e-5);
}

// A mirrored part: the triangles lie where the matrix puts them, whatever their winding becomes.
TEST_F(Gltf, MirrorsWhereANodeDoes) {
    Parts parts;
    parts.nodes = R"([{"mesh":0,"translation":[5,0,0],"scale":[-2,1,1]}])";
    const ModelExtent by_scale = extent_of(load(parts).mesh);
    parts.nodes = R"([{"mesh":0,"matrix":[-2,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]}])";
    const Mesh by_matrix = load(parts).mesh;
    EXPECT_EQ(by_matrix.triangles.size(), 12U);
    EXPECT_NEAR(surface_area_m2(by_matrix), 2.0 * (2.0 + 2.0 + 1.0), 1e-5);
    for (const ModelExtent& extent : {by_scale, extent_of(by_matrix)}) {
        EXPECT_LT((extent.box_min_in_object - Eigen::Vector3d(4.0, -0.5, -0.5)).norm(), 1e-5);
        EXPECT_LT((extent.box_max_in_object - Eigen::Vector3d(6.0, 0.5, 0.5)).norm(), 1e-5);
    }
    // The third corner of the first triangle, at +x, comes to lie at the low end.
    EXPECT_NEAR(by_matrix.vertices_in_object[static_cast<std::size_t>(by_matrix.triangles[0][2])].x(), 4.0F, 1e-5F);
}

TEST_F(Gltf, NamesOfBuffersMayHaveEscapes) {
    std::filesystem::rename(folder_ / "cube.bin", folder_ / "a cube (1).bin");
    for (const std::string uri : {"a%20cube%20(1).bin", "a cube (1).bin", "%61%20cube%20%281%29.bin"}) {
        Parts parts;
        parts.uri = ",\"uri\":\"" + uri + "\"";
        EXPECT_EQ(load(parts).mesh.triangles.size(), 12U) << uri;
    }
}

TEST_F(Gltf, AByteOrderMarkIsNoPartOfTheText) {
    EXPECT_EQ(load_mesh(write("cube.gltf", "\xEF\xBB\xBF" + gltf({})), kUnit).mesh.triangles.size(), 12U);
}

TEST_F(Gltf, NestedBracketsAreRefusedBeforeTheyOverflowTheStack) {
    for (const char bracket : {'[', '{'}) {
        Parts parts;
        parts.more = R"(,"extras":)" + std::string(4 << 20, bracket);
        EXPECT_THROW(load(parts), std::runtime_error);
    }
    Parts parts;
    parts.more = R"(,"extras":)" + std::string(2 << 20, '[') + std::string(2 << 20, ']');
    expect_refused(parts, "nested deeper than 64");
    parts.more = R"(,"extras":)" + std::string(50, '[') + std::string(50, ']');
    EXPECT_NO_THROW(load(parts));
}

TEST_F(Gltf, DeepAndManifoldNodesAreRefused) {
    const auto chain = [](int length, const std::string& children) {
        std::string nodes = "[";
        for (int i = 0; i + 1 < length; ++i) {
            std::string child = std::to_string(i + 1);
            nodes += R"({"children":[)" + child + (children == "two" ? "," + child : "") + "]},";
        }
        return nodes + R"({"mesh":0}])";
    };
    Parts parts;
    parts.nodes = chain(200000, "one");
    expect_refused(parts, "nested deeper");
    parts.nodes = chain(40, "two");
    expect_refused(parts, "more often");
    parts.nodes = chain(100, "one");
    EXPECT_EQ(load(parts).mesh.triangles.size(), 12U);
    parts.nodes = R"([{"children":[1]},{"children":[0],"mesh":0}])";
    expect_refused(parts, "contains itself");
    parts = Parts();
    parts.roots = "[0";
    for (int i = 0; i < 200000; ++i) parts.roots += ",0";
    parts.roots += "]";
    expect_refused(parts, "more often");
}

TEST_F(Gltf, OpensNothingOutsideItsFolder) {
    std::filesystem::create_directory(folder_ / "inner");
    std::filesystem::create_symlink(folder_ / "cube.bin", folder_ / "inner" / "link.bin");
    ASSERT_EQ(::mkfifo((folder_ / "inner" / "pipe.bin").c_str(), 0600), 0);
    for (const std::string uri : {"../cube.bin",
                                  "link.bin",
                                  "pipe.bin",
                                  "/dev/zero",
                                  "..",
                                  ".",
                                  "",
                                  "%2e%2e/cube.bin",
                                  "..\\\\cube.bin",
                                  "..\\u002fcube.bin",
                                  "file:///dev/zero",
                                  "none.bin",
                                  "%2e%2e%2fcube.bin",
                                  "%2Fdev%2Fzero",
                                  "%00",
                                  "%2",
                                  "%zz",
                                  "%22",
                                  "%5ccube.bin",
                                  "%2e%2e"}) {
        Parts parts;
        parts.uri = ",\"uri\":\"" + uri + "\"";
        const auto path = write("inner/cube.gltf", gltf(parts));
        expect_error<std::runtime_error>([&] { load_mesh(path, kUnit); }, "not a regular file beside it");
    }
}

TEST_F(Gltf, RefusesSizesAndIndicesOutOfRange) {
    const auto with = [](auto change) {
        Parts parts;
        change(parts);
        return parts;
    };
    expect_refused(with([](Parts& p) { p.count = "37"; }), "beyond its buffer view");
    expect_refused(with([](Parts& p) { p.count = "4000000000"; }), "limit");
    expect_refused(with([](Parts& p) { p.count = "-1"; }), "not a number of 0 or more");
    expect_refused(with([](Parts& p) { p.view_bytes = "73"; }), "beyond its buffer");
    expect_refused(with([](Parts& p) { p.view_bytes = "9223372036854775807"; }), "not a number");
    expect_refused(with([](Parts& p) { p.buffer_bytes = "169"; }), "shorter than its buffer");
    expect_refused(with([](Parts& p) { p.buffer_bytes = "1000000000000"; }), "above the limit");
    expect_refused(with([](Parts& p) { p.uri = ""; }), "neither a uri");
    expect_refused(with([](Parts& p) { p.uri = R"(,"uri":"data:;base64,AAAA")"; }), "shorter than its buffer");
    expect_refused(with([](Parts& p) { p.uri = ",\"uri\":\"data:;base64,\xFF\xFF\xFF\xFF\""; }), "not valid base64");
    expect_refused(with([](Parts& p) { p.roots = "[1]"; }), "refers to nothing");
    expect_refused(with([](Parts& p) { p.nodes = R"([{"mesh":1}])"; }), "refers to nothing");
    expect_refused(with([](Parts& p) { p.nodes = R"([{"mesh":0,"children":[7]}])"; }), "refers to nothing");
    expect_refused(with([](Parts& p) { p.nodes = R"([{"mesh":0,"scale":[1,1]}])"; }), "not 3 numbers");
    expect_refused(with([](Parts& p) { p.primitive = R"({"attributes":{"POSITION":9}})"; }), "refers to nothing");
    expect_refused(with([](Parts& p) { p.primitive = R"({"attributes":{"POSITION":1}})"; }), "three floats");
    expect_refused(with([](Parts& p) { p.primitive = R"({"attributes":{"POSITION":0},"indices":0})"; }), "unsigned");
    expect_refused(with([](Parts& p) { p.more = R"(,"extensionsRequired":["KHR_draco_mesh_compression"])"; }), "draco");
}

// The same accessor in very many primitives would be copied for each.
TEST_F(Gltf, RefusesMorePrimitivesThanTheLimitHolds) {
    Parts parts;
    const std::string one = parts.primitive;
    for (int i = 0; i < 999; ++i) parts.primitive += "," + one;
    MeshLimits limits;
    limits.max_triangles = 1000;
    expect_error<std::runtime_error>([&] { load_mesh(write("many.gltf", gltf(parts)), kUnit, limits); }, "limit");
}

TEST_F(Gltf, DropsFacesWithIndicesBeyondTheVertices) {
    std::string buffer = cube_buffer();
    buffer[96] = 99;
    write("cube.bin", buffer);
    EXPECT_EQ(load({}).mesh.triangles.size(), 11U);
}

TEST_F(Gltf, MutantsLoadOrThrow) {
    std::mt19937 random(777);
    Parts chunk;
    chunk.uri = "";
    const std::string whole[] = {gltf({}), glb(gltf(chunk), cube_buffer())};
    int loaded = 0, refused = 0;
    for (int mutant = 0; mutant < 400; ++mutant) {
        std::string bytes = whole[mutant % 2];
        for (std::size_t edit = 0, count = 1 + random() % 3; edit < count; ++edit) {
            bytes[random() % bytes.size()] = static_cast<char>(random() % 2 == 0 ? '0' + random() % 10 : random());
        }
        try {
            load_mesh(write(mutant % 2 == 0 ? "m.gltf" : "m.glb", bytes), kUnit);
            ++loaded;
        } catch (const std::runtime_error&) {
            ++refused;
        }
    }
    EXPECT_EQ(loaded + refused, 400);
    EXPECT_GT(loaded, 20);
    EXPECT_GT(refused, 50);
}

TEST_F(Gltf, CutGlbIsRefused) {
    Parts chunk;
    chunk.uri = "";
    const std::string whole = glb(gltf(chunk), cube_buffer());
    for (std::size_t size = 0; size < whole.size(); size += 7) {
        EXPECT_THROW(load_mesh(write("cut.glb", whole.substr(0, size)), kUnit), std::runtime_error) << size;
    }
}

}  // namespace
}  // namespace nearpose::test
