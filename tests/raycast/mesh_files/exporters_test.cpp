// What exporters write beside the letter of a format, where its meaning is plain: each file is the same box.
#include <cstring>

#include "raycast/mesh_loader.hpp"
#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

const std::string kMark = "\xEF\xBB\xBF";  // a byte order mark

const Eigen::Vector3f kHalf_mm(30.5F, 20.25F, 47.125F);

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
    return text;
}

std::string row(const Eigen::Vector3f& vertex) {
    return std::to_string(vertex.x()) + " " + std::to_string(vertex.y()) + " " + std::to_string(vertex.z());
}

std::string obj() {
    std::string text;
    for (const Eigen::Vector3f& vertex : make_box(kHalf_mm).vertices_in_object) text += "v " + row(vertex) + "\n";
    return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

std::string text_stl() {
    std::string text = "solid part\n";
    const Mesh box = make_box(kHalf_mm);
    for (const auto& triangle : box.triangles) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const int corner : triangle)
            text += "vertex " + row(box.vertices_in_object[static_cast<std::size_t>(corner)]) + "\n";
        text += "endloop\nendfacet\n";
    }
    return text + "endsolid part\n";
}

std::string binary_stl() {
    std::string bytes(80, ' ');
    const std::uint32_t count = 12;
    bytes.append(reinterpret_cast<const char*>(&count), 4);
    const Mesh box = make_box(kHalf_mm);
    for (const auto& triangle : box.triangles) {
        bytes.append(12, '\0');
        for (const int corner : triangle) {
            bytes.append(reinterpret_cast<const char*>(box.vertices_in_object[static_cast<std::size_t>(corner)].data()),
                         12);
        }
        bytes.append(2, '\0');
    }
    return bytes;
}

// `more` is what follows the vertices' and the faces' rows.
std::string rows(const std::string& after_vertex, const std::string& after_face) {
    std::string text;
    for (const Eigen::Vector3f& vertex : make_box(kHalf_mm).vertices_in_object)
        text += row(vertex) + after_vertex + "\n";
    for (const char* face : {"0 2 3 1", "4 5 7 6", "0 1 5 4", "2 6 7 3", "0 4 6 2", "1 3 7 5"})
        text += "4 " + std::string(face) + after_face + "\n";
    return text;
}

std::string ply_header(const std::string& format, const std::string& face_properties = "") {
    return "ply\nformat " + format +
           " 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 6\n"
           "property list uchar int vertex_indices\n" +
           face_properties + "end_header\n";
}

std::string text_ply(const std::string& after_face = "", const std::string& face_properties = "") {
    return ply_header("ascii", face_properties) + rows("", after_face);
}

std::string binary_ply(const std::string& face_properties = "", const std::string& after_face = "") {
    std::string bytes = ply_header("binary_little_endian", face_properties);
    for (const Eigen::Vector3f& vertex : make_box(kHalf_mm).vertices_in_object)
        bytes.append(reinterpret_cast<const char*>(vertex.data()), 12);
    constexpr int kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& face : kFaces) {
        bytes += '\4';
        bytes.append(reinterpret_cast<const char*>(face), 16);
        bytes += after_face;
    }
    return bytes;
}

class Exporters : public FolderTest {
  protected:
    void expect_box(const std::string& name, const std::string& bytes) const {
        SCOPED_TRACE(name);
        const LoadedMesh loaded = load_mesh(write(name, bytes), LengthUnit::kMillimetre);
        EXPECT_EQ(loaded.mesh.triangles.size(), 12U);
        EXPECT_EQ(loaded.mesh.vertices_in_object.size(), 8U);
        EXPECT_EQ(loaded.repair.triangles_bad_index, 0);
        const ModelExtent extent = extent_of(loaded.mesh);
        EXPECT_LT((1e3 * extent.box_max_in_object - kHalf_mm.cast<double>()).norm(), 1e-4);
        EXPECT_LT((1e3 * extent.box_min_in_object + kHalf_mm.cast<double>()).norm(), 1e-4);
        const Eigen::Vector3d sides = 2.0 * kHalf_mm.cast<double>();
        EXPECT_NEAR(1e6 * surface_area_m2(loaded.mesh),
                    2.0 * (sides.x() * sides.y() + sides.y() * sides.z() + sides.z() * sides.x()), 0.1);
    }
    void expect_refused(const std::string& name, const std::string& bytes, const std::string& part) const {
        const auto path = write(name, bytes);
        expect_error<std::runtime_error>([&] { load_mesh(path, LengthUnit::kMillimetre); }, part);
    }
};

TEST_F(Exporters, AByteOrderMarkIsNoPartOfTheText) {
    expect_box("a.obj", kMark + obj());
    expect_box("a.stl", kMark + text_stl());
    expect_box("a.ply", kMark + text_ply());
    expect_box("b.ply", kMark + binary_ply());
    expect_box("a.off", kMark + "OFF\n8 6 0\n" + rows("", ""));
    expect_refused("b.obj", "\xFF\xFE" + obj(), "UTF-16; save it as UTF-8");
}

TEST_F(Exporters, ObjLinesGoOnAfterABackslashAndEndBeforeAComment) {
    expect_box("a.obj", replaced(obj(), "f 1 3 4 2", "f 1 3 \\\n4 2"));
    expect_box("b.obj", replaced(obj(), "f 1 3 4 2", "f 1 3\\\r\n\\\r\n 4 2"));
    expect_box("c.obj", replaced(obj(), "\n", " # from C:\\parts\\\n"));
    expect_box("d.obj", replaced(obj(), "f 1 3 4 2", "f 1 3 4 2#bottom"));
    expect_box("e.obj", "# path\\\n" + obj() + "f \\\n\\");
    expect_refused("f.obj", obj() + "f 1 2 \\ 3\n", "not the corner");
}

TEST_F(Exporters, TextStlMayHaveCapitalsAndSpaces) {
    std::string capitals = text_stl();
    for (char& letter : capitals) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    expect_box("a.stl", capitals);
    expect_box("b.stl", replaced(text_stl(), "end", "end "));
    expect_box("c.stl", replaced(text_stl(), "solid", "Solid"));
    expect_box("d.stl", "  \t" + replaced(text_stl(), "\n", "\r\n\f"));
}

TEST_F(Exporters, BinaryFilesMayHaveBytesBehind) {
    expect_box("a.stl", binary_stl() + "\n");
    expect_box("b.stl", binary_stl() + std::string(49, 'x'));
    expect_box("c.stl", binary_stl() + std::string(4096, '\0'));
    expect_box("d.stl", "solid" + binary_stl().substr(5) + "\n");
    expect_box("a.ply", binary_ply() + "\r\n");
    expect_box("b.ply", binary_ply() + std::string(7, '\0'));
    expect_refused("c.ply", binary_ply() + "\nx", "2 bytes more");
}

TEST_F(Exporters, PlyMayHaveEmptyLinesAndColoursOfFaces) {
    expect_box("a.ply", replaced(text_ply(), "element", "\nelement") + "\n \n");
    expect_box("b.ply", replaced(binary_ply(), "element", "\r\nelement"));
    const std::string colour = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    expect_box("c.ply", text_ply(" 255 0 7", colour));
    expect_box("d.ply", binary_ply(colour, "\1\2\3"));
    expect_box("e.ply", text_ply(" 255 0 7"));
    expect_box("f.ply", text_ply(" 255 0 7 255"));
    for (const std::string more : {" 1", " 1 2", " 1 2 3 4 5", " 1 2 256", " 1 -2 3", " 1 2 0.5"})
        expect_refused("g.ply", text_ply(more), "more values than the header says");
}

TEST_F(Exporters, OffMayHaveNormalsColoursAndAnyNumberOfCorners) {
    expect_box("a.off", "NOFF\n8 6 0\n" + rows(" 0 0 1", ""));
    expect_box("b.off", "CNOFF 8 6 0\n" + rows(" 0 0 1 255 0 0 255", " 3 0.5 0.5 0.5"));
    expect_box("c.off", "STOFF\n8 6\n" + rows(" 0.5 0.5 # " + std::string(5000, 'x'), ""));
    std::string disc = "OFF\n100 1 0\n", face = "100";
    for (int k = 0; k < 100; ++k) {
        disc += std::to_string(100.0 * std::cos(0.02 * M_PI * k)) + " " +
                std::to_string(100.0 * std::sin(0.02 * M_PI * k)) + " 0\n";
        face.append(" ").append(std::to_string(k));
    }
    const Mesh mesh = load_mesh(write("d.off", disc + face + "\n"), LengthUnit::kMillimetre).mesh;
    EXPECT_EQ(mesh.triangles.size(), 98U);
    EXPECT_NEAR(1e6 * surface_area_m2(mesh), 50.0 * 1e4 * std::sin(0.02 * M_PI), 0.1);
}

}  // namespace
}  // namespace nearpose::test
