// The same solid through every format, OFF files, and meshes from memory.
#include <sstream>

#include "raycast/mesh_loader.hpp"
#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

constexpr LengthUnit kUnit = LengthUnit::kMillimetre;

// Its own half sides, so that no axis can stand for another [mm].
Mesh solid() {
    return make_box({30.5F, 20.25F, 47.125F});
}

const Eigen::Vector3f& corner(const Mesh& mesh, std::size_t triangle, std::size_t k) {
    return mesh.vertices_in_object[static_cast<std::size_t>(mesh.triangles[triangle][k])];
}

std::string row(const Eigen::Vector3f& vertex) {
    std::ostringstream text;
    text << vertex.x() << ' ' << vertex.y() << ' ' << vertex.z() << '\n';
    return text.str();
}

// Vertices and triangles as rows; `before` and `first` are what the format puts before a row and its lowest index.
std::string rows(const Mesh& mesh, const std::string& before_vertex, const std::string& before_face, int first) {
    std::string text;
    for (const Eigen::Vector3f& vertex : mesh.vertices_in_object) text += before_vertex + row(vertex);
    for (const auto& triangle : mesh.triangles) {
        text += before_face;
        for (int index : triangle) text += std::to_string(index + first) + " ";
        text += "\n";
    }
    return text;
}

std::string off(const Mesh& mesh, const std::string& header = "OFF\n8 12 0\n") {
    return header + rows(mesh, "", "3 ", 0);
}

std::string text_stl(const Mesh& mesh) {
    std::string text = "solid a part\n";
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        text += "facet normal 0 0 0\n outer loop\n";
        for (std::size_t k = 0; k < 3; ++k) text += "  vertex " + row(corner(mesh, t, k));
        text += " endloop\nendfacet\n";
    }
    return text + "endsolid a part\n";
}

template <typename T>
void put(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

std::string binary_stl(const Mesh& mesh) {
    std::string bytes(80, ' ');
    put(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        bytes.append(12, '\0');
        for (std::size_t k = 0; k < 3; ++k) bytes.append(reinterpret_cast<const char*>(corner(mesh, t, k).data()), 12);
        bytes.append(2, '\0');
    }
    return bytes;
}

// Positions and 16-bit indices.
std::string gltf_buffer(const Mesh& mesh) {
    std::string bytes;
    for (const Eigen::Vector3f& vertex : mesh.vertices_in_object) {
        bytes.append(reinterpret_cast<const char*>(vertex.data()), 12);
    }
    for (const auto& triangle : mesh.triangles) {
        for (int index : triangle) put(bytes, static_cast<std::uint16_t>(index));
    }
    return bytes;
}

std::string gltf(const std::string& uri) {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":)"
           R"([{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":8,)"
           R"("type":"VEC3"},{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}],"bufferViews":[{"buffer":0,)"
           R"("byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":72}],"buffers":[{"byteLength":168)" +
           uri + "}]}";
}

std::string glb(const Mesh& mesh) {
    std::string json = gltf("");
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::string buffer = gltf_buffer(mesh);
    std::string bytes = "glTF";
    for (const std::size_t number : {std::size_t{2}, 28 + json.size() + buffer.size(), json.size()}) {
        put(bytes, static_cast<std::uint32_t>(number));
    }
    bytes += "JSON" + json;
    put(bytes, static_cast<std::uint32_t>(buffer.size()));
    return bytes + std::string("BIN\0", 4) + buffer;
}

class Import : public FolderTest {
  protected:
    void expect_off_refused(const std::string& bytes, const std::string& part) const {
        const auto path = write("mesh.off", bytes);
        expect_error<std::runtime_error>([&] { load_mesh(path, kUnit); }, part);
        expect_error<std::runtime_error>([&] { load_mesh(path, kUnit); }, "mesh.off: ");
    }
};

// The same triangles, corner by corner, in the same order.
void expect_same(const Mesh& mesh, const Mesh& expected_in_mm, const std::string& name) {
    EXPECT_EQ(mesh.vertices_in_object.size(), expected_in_mm.vertices_in_object.size()) << name;
    ASSERT_EQ(mesh.triangles.size(), expected_in_mm.triangles.size()) << name;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Eigen::Vector3f expected = 1e-3F * corner(expected_in_mm, t, k);
            ASSERT_LT((corner(mesh, t, k) - expected).norm(), 1e-7F) << name << ", triangle " << t;
        }
    }
}

TEST_F(Import, EveryFormatGivesTheSameTriangles) {
    const Mesh part = solid();
    save_ply(part, folder_ / "part.ply", LengthUnit::kMetre);  // its numbers as they are
    write("part.obj", rows(part, "v ", "f ", 1));
    write("text.stl", text_stl(part));
    write("binary.stl", binary_stl(part));
    write("part.off", off(part));
    write("part.bin", gltf_buffer(part));
    write("part.gltf", gltf(R"(,"uri":"part.bin")"));
    write("part.glb", glb(part));
    for (const std::string name :
         {"part.ply", "part.obj", "text.stl", "binary.stl", "part.off", "part.gltf", "part.glb"}) {
        expect_same(load_mesh(folder_ / name, kUnit).mesh, part, name);
    }
}

TEST_F(Import, BytesOfAPlyAreReadAsItsFileIs) {
    const Mesh part = solid();
    save_ply(part, folder_ / "part.ply", LengthUnit::kMetre);
    std::ostringstream content;
    content << std::ifstream(folder_ / "part.ply", std::ios::binary).rdbuf();
    const std::string bytes = content.str();
    expect_same(load_mesh_from_bytes(bytes, "built-in part", kUnit).mesh, part, "bytes");
    expect_error<std::runtime_error>([&] { load_mesh_from_bytes(bytes.substr(0, 300), "built-in part", kUnit); },
                                     "built-in part: ");
    expect_error<std::runtime_error>([&] { load_mesh_from_bytes(bytes, "part", LengthUnit::kMetre); }, "--unit mm");
    MeshLimits limits;
    limits.max_file_bytes = bytes.size() - 1;
    expect_error<std::runtime_error>([&] { load_mesh_from_bytes(bytes, "part", kUnit, limits); }, "limit");
}

TEST_F(Import, OffMayHaveCommentsColoursAndPolygons) {
    const Mesh part = solid();
    const std::string header = "# made by hand\n\nOFF 8 12 0\n# vertices\n";
    expect_same(load_mesh(write("a.off", off(part, header)), kUnit).mesh, part, "comments");
    std::string crlf;
    for (const char letter : off(part)) crlf += letter == '\n' ? std::string("\r\n") : std::string(1, letter);
    expect_same(load_mesh(write("b.off", crlf), kUnit).mesh, part, "line ends");

    std::string coloured = "COFF\n8 6 12\n";
    for (const Eigen::Vector3f& vertex : part.vertices_in_object) {
        const std::string line = row(vertex);
        coloured += line.substr(0, line.size() - 1) + " 255 0 0 255\n";
    }
    coloured += "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5 255 0 0\n";
    const Mesh squares = load_mesh(write("c.off", coloured), kUnit).mesh;
    EXPECT_EQ(squares.triangles.size(), 12U);
    EXPECT_EQ(squares.vertices_in_object.size(), 8U);
    EXPECT_NEAR(extent_of(squares).diameter_m(), 1e-3 * extent_of(part).diameter_m(), 1e-7);
}

TEST_F(Import, OffRefusesWhatIsBroken) {
    const std::string whole = off(solid());
    const auto with = [&](const std::string& old_text, const std::string& new_text) {
        std::string changed = whole;
        return changed.replace(changed.find(old_text), old_text.size(), new_text);
    };
    expect_off_refused(with("8 12 0", "1000000000 12 0"), "do not fit into the file");
    expect_off_refused(with("8 12 0", "8 4294967295 0"), "do not fit into the file");
    expect_off_refused(with("8 12 0", "-8 12 0"), "do not fit into the file");
    expect_off_refused(with("8 12 0", "8 13 0"), "cut short");
    expect_off_refused(with("8 12 0", "8 11 0"), "more rows");
    expect_off_refused(with("8 12 0", "8 0 0"), "no faces");
    expect_off_refused(with("3 0 2 1", "3 0 2 8"), "does not exist");
    expect_off_refused(with("3 0 2 1", "3 0 2 -1"), "does not exist");
    expect_off_refused(with("3 0 2 1", "3 0 2"), "does not exist");
    expect_off_refused(with("3 0 2 1", "0"), "a face has no corners");
    expect_off_refused(with("3 0 2 1", "1000000000 0 1 2"), "does not exist");
    expect_off_refused(with("30.5", "30,5"), "three numbers");
    expect_off_refused(with("OFF", "4OFF"), "not OFF, COFF, NOFF");
    expect_off_refused("OFF BINARY\n" + std::string(100, '\0'), "not a text file");
    MeshLimits limits;
    limits.max_triangles = 11;
    expect_error<std::runtime_error>([&] { load_mesh(write("a.off", whole), kUnit, limits); }, "limit of 11");
    for (std::size_t size = 0; size + 5 < whole.size(); ++size) {
        EXPECT_THROW(load_mesh(write("cut.off", whole.substr(0, size)), kUnit), std::runtime_error) << size;
    }
}

TEST_F(Import, MutantsOfOffAndStlLoadOrThrow) {
    std::mt19937 random(2468);
    const std::pair<std::string, std::string> files[] = {
        {"m.off", off(solid())}, {"m.stl", binary_stl(solid())}, {"m.stl", text_stl(solid())}};
    const std::string numbers[] = {"99", "-1", "4294967295", "1000000000", "nan", "1e400", "0x1p3", ""};
    int loaded = 0, refused = 0;
    for (const auto& [name, whole] : files) {
        for (int mutant = 0; mutant < 300; ++mutant) {
            std::string bytes = whole;
            for (std::size_t edit = 0, count = 1 + random() % 3; edit < count; ++edit) {
                const std::size_t place = random() % bytes.size();
                const std::size_t kind = random() % 3;
                if (kind == 0) bytes[place] = static_cast<char>(random());
                if (kind == 1) bytes.replace(place, random() % 4, numbers[random() % std::size(numbers)]);
                if (kind == 2) bytes[place] = static_cast<char>('0' + random() % 10);
            }
            try {
                const Mesh mesh = load_mesh(write(name, bytes), kUnit).mesh;
                ++loaded;
                for (const auto& triangle : mesh.triangles) {
                    for (int index : triangle)
                        ASSERT_LT(static_cast<std::size_t>(index), mesh.vertices_in_object.size());
                }
                for (const Eigen::Vector3f& vertex : mesh.vertices_in_object) ASSERT_TRUE(vertex.allFinite());
            } catch (const std::runtime_error&) {
                ++refused;
            }
        }
    }
    EXPECT_EQ(loaded + refused, 900);
    EXPECT_GT(loaded, 100);
    EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace nearpose::test
