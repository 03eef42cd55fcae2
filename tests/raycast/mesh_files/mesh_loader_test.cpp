// STL and OBJ files, units, and what is common to all formats.
#include "raycast/mesh_loader.hpp"

#include <sys/stat.h>

#include <cstring>

#include "raycast/mesh_files/readers.hpp"
#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

constexpr LengthUnit kUnit = LengthUnit::kMetre;

std::string obj_cube(const std::string& before = "") {
    return before +
           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0 0.5 0.5 0.5\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\nvt 0 0\nvn 0 0 1\n"
           "f 1 2 4 3\nf 5/1 6/1 8/1 7/1\nf 1//1 2//1 6//1 5//1\nf 3/1/1 4/1/1 8/1/1 7/1/1\nf -8 -6 -2 -4\nf 2 4 8 6\n";
}

std::string text_stl() {
    std::string text = "solid box\n";
    const Mesh box = make_box({0.5F, 0.5F, 0.5F});
    for (const auto& triangle : box.triangles) {
        text += "  facet normal 0 0 0\n    outer loop\n";
        for (int corner : triangle) {
            const Eigen::Vector3f& vertex = box.vertices_in_object[static_cast<std::size_t>(corner)];
            text += "      vertex";
            for (int axis = 0; axis < 3; ++axis) text += vertex[axis] > 0.0F ? " 5.0e-1" : " -0.5";
            text += "\n";
        }
        text += "    endloop\n  endfacet\n";
    }
    return text + "endsolid box\n";
}

std::string binary_stl(std::uint32_t count = 12, const std::string& title = "solid by name only") {
    std::string bytes = title;
    bytes.resize(80, ' ');
    bytes.append(reinterpret_cast<const char*>(&count), 4);
    const Mesh box = make_box({0.5F, 0.5F, 0.5F});
    for (const auto& triangle : box.triangles) {
        bytes.append(12, '\0');
        for (int corner : triangle) {
            bytes.append(reinterpret_cast<const char*>(box.vertices_in_object[static_cast<std::size_t>(corner)].data()),
                         12);
        }
        bytes.append(2, '\0');
    }
    return bytes;
}

class MeshLoader : public FolderTest {
  protected:
    void expect_refused(const std::string& name, const std::string& bytes, const std::string& part) const {
        const auto path = write(name, bytes);
        expect_error<std::runtime_error>([&] { load_mesh(path, kUnit); }, part);
        expect_error<std::runtime_error>([&] { load_mesh(path, kUnit); }, name);
    }
    void expect_cube(const std::string& name, const std::string& bytes) const {
        const LoadedMesh loaded = load_mesh(write(name, bytes), kUnit);
        EXPECT_EQ(loaded.mesh.triangles.size(), 12U) << name;
        EXPECT_EQ(loaded.mesh.vertices_in_object.size(), 8U) << name;
        EXPECT_NEAR(extent_of(loaded.mesh).diameter_m(), std::sqrt(3.0), 1e-6) << name;
    }
};

TEST_F(MeshLoader, ReadsEveryFormatByItsExtension) {
    expect_cube("a.obj", obj_cube());
    expect_cube("b.OBJ", obj_cube());
    expect_cube("c.stl", text_stl());
    expect_cube("d.STL", binary_stl());
    const std::string formats = "models are read from .ply, .stl, .obj, .off, .gltf and .glb files, not ";
    expect_refused("e.step", "ISO-10303-21;", formats + "\".step\"; export the model as PLY, STL or OBJ");
    expect_refused("f", obj_cube(), formats + "\"\"");
    expect_refused("g.DAE", "<COLLADA/>", ".dae files are not read");
    expect_refused("h.3mf", "PK", "export the model as PLY, STL or OBJ");
}

TEST_F(MeshLoader, RefusesWhatIsNoRegularFile) {
    expect_error<std::runtime_error>([&] { load_mesh(folder_ / "none.ply", kUnit); }, "none.ply: no such file");
    std::filesystem::create_directory(folder_ / "folder.ply");
    expect_error<std::runtime_error>([&] { load_mesh(folder_ / "folder.ply", kUnit); }, "not a regular file");
    ASSERT_EQ(::mkfifo((folder_ / "pipe.obj").c_str(), 0600), 0);
    expect_error<std::runtime_error>([&] { load_mesh(folder_ / "pipe.obj", kUnit); }, "not a regular file");
    for (const std::string name : {"empty.ply", "empty.stl", "empty.obj", "empty.off", "empty.glb", "empty.gltf"}) {
        EXPECT_THROW(load_mesh(write(name, ""), kUnit), std::runtime_error) << name;
    }
}

// Opening a pipe would wait for ever, and a material library is not needed.
TEST_F(MeshLoader, ObjOpensNoOtherFile) {
    ASSERT_EQ(::mkfifo((folder_ / "pipe.mtl").c_str(), 0600), 0);
    expect_cube("a.obj", obj_cube("mtllib pipe.mtl\nusemtl a\n"));
    expect_cube("a.obj", obj_cube("mtllib ../../x\nmtllib /dev/zero\ncall pipe.mtl\n"));
}

TEST_F(MeshLoader, ObjCountsCornersThatDoNotExist) {
    for (const std::string face : {"f 1 2 99\n", "f 1 2 0\n", "f 1 2 -9\n", "f 1 2 4294967295\n"}) {
        const LoadedMesh loaded = load_mesh(write("a.obj", obj_cube() + face), kUnit);
        EXPECT_EQ(loaded.repair.triangles_bad_index, 1) << face;
        EXPECT_EQ(loaded.mesh.triangles.size(), 12U);
    }
    EXPECT_EQ(load_mesh(write("a.obj", obj_cube() + "f\nf 1\nf 1 2\n"), kUnit).repair.triangles_degenerate, 3);
    EXPECT_EQ(load_mesh(write("a.obj", obj_cube() + "v nan 1 inf\nf 1 2 9\n"), kUnit).repair.triangles_not_finite, 1);
}

TEST_F(MeshLoader, ObjRefusesWhatItCannotRead) {
    expect_refused("a.obj", obj_cube() + "f 1 2 x\n", "line 17");
    expect_refused("a.obj", obj_cube() + "f 99999999999999999999 1 2\n", "not the corner");
    expect_refused("a.obj", "v 1 2\n", "three numbers");
    expect_refused("a.obj", "v 1,5 2 3\n", "three numbers");
    expect_refused("a.obj", "v 1 2 3\nv 1 2 4\nv 1 2 5\nv 2 3 4\nv 3 3 3\nv 1 5 6\n", "no faces");
}

TEST_F(MeshLoader, StlRefusesCutAndWrongFiles) {
    const std::string binary = binary_stl();
    for (const std::size_t size : {std::size_t{0}, std::size_t{83}, std::size_t{84}, binary.size() - 1}) {
        EXPECT_THROW(load_mesh(write("a.stl", binary.substr(0, size)), kUnit), std::runtime_error) << size;
    }
    expect_refused("a.stl", binary_stl(12, "title").substr(0, 500), "not 500: it is cut short");
    expect_refused("a.stl", binary_stl(12, "title") + std::string(50, 'x'), "not 734: it is too long");
    // 85899346 triangles of 50 bytes are 4 more than 2^32: in 32 bits a file of 88 bytes would do.
    expect_refused("a.stl", binary_stl(85899346U, "title").substr(0, 88), "it would have 4294967384 bytes, not 88");
    for (const std::uint32_t count : {0U, 11U, 13U, 1000000000U, 4294967295U, 85899346U}) {
        EXPECT_THROW(load_mesh(write("a.stl", binary_stl(count, "title")), kUnit), std::runtime_error) << count;
    }
    expect_refused("a.stl", binary_stl(0, "title").substr(0, 84), "no triangles");
    const std::string text = text_stl();
    expect_refused("a.stl", text.substr(0, text.find("endsolid")), "cut short");
    expect_refused("a.stl", text.substr(0, text.size() / 2), ": line ");
    expect_refused("a.stl", "solid\nfacet normal 0 0 1\nvertex 1 2 3\nvertex 1 2 4\nendfacet\nendsolid\n", "three");
    expect_refused("a.stl", "solid\nfacet normal 0 0 1\nvertex 1 2 3\nvertex 1 2 4\nvertex 1 1 1\nvertex 2 2 2\n",
                   "more than three");
    expect_refused("a.stl", "solid\nvertex 1,5 2 3\n", "three numbers");
    expect_refused("a.stl", "solid\nfacet normal 0 x 1\n", "a normal needs three numbers");
    expect_refused("a.stl", "solid\nfacet\n", "without a normal");
    expect_refused("a.stl", "solid\nendfacet\n", "without a beginning");
    expect_refused("a.stl", "solid\nendsolid\n", "no triangles");
    expect_refused("a.stl", "solid\nsolid\nendsolid\n", "without an end");
    MeshLimits limits;
    limits.max_triangles = 11;
    for (const std::string& bytes : {binary, text}) {
        expect_error<std::runtime_error>([&] { load_mesh(write("a.stl", bytes), kUnit, limits); }, "limit of 11");
    }
}

TEST_F(MeshLoader, StlWithNumbersThatAreNotFiniteLosesTheirTrianglesAndCountsThem) {
    std::string text = text_stl();
    text.replace(text.find("5.0e-1"), 6, "nan");
    const LoadedMesh loaded = load_mesh(write("a.stl", text), kUnit);
    EXPECT_EQ(loaded.repair.triangles_not_finite, 1);
    EXPECT_EQ(loaded.mesh.triangles.size(), 11U);
}

TEST_F(MeshLoader, MutantsOfStlAndObjLoadOrThrow) {
    std::mt19937 random(54321);
    int loaded = 0, refused = 0;
    const std::pair<std::string, std::string> files[] = {
        {"a.stl", binary_stl()}, {"a.stl", text_stl()}, {"a.obj", obj_cube()}};
    for (const auto& [name, whole] : files) {
        for (int mutant = 0; mutant < 300; ++mutant) {
            std::string bytes = whole;
            for (std::size_t edit = 0, count = 1 + random() % 4; edit < count; ++edit) {
                const std::size_t place = random() % bytes.size();
                if (random() % 3 == 0) {
                    bytes.erase(place, 1 + random() % 4);
                } else {
                    bytes[place] = static_cast<char>(random());
                }
            }
            try {
                MeshRepair repair;
                const Mesh mesh =
                    clean(name == "a.stl" ? read_stl(bytes, name, {}) : read_obj(bytes, name, {}, repair), name);
                ++loaded;
                for (const auto& triangle : mesh.triangles) {
                    for (int corner : triangle) {
                        ASSERT_LT(static_cast<std::size_t>(corner), mesh.vertices_in_object.size());
                    }
                }
            } catch (const std::runtime_error&) {
                ++refused;
            }
        }
    }
    EXPECT_EQ(loaded + refused, 900);
    EXPECT_GT(loaded, 50);
    EXPECT_GT(refused, 100);
}

TEST_F(MeshLoader, ConvertsUnitsAndNamesTheLikelyOne) {
    Mesh part = make_box({0.09F, 0.06F, 0.1F});  // 0.3 m across
    save_ply(part, folder_ / "part.ply", LengthUnit::kMillimetre);
    const auto path = folder_ / "part.ply";
    EXPECT_NEAR(extent_of(load_mesh(path, LengthUnit::kMillimetre).mesh).diameter_m(), 0.295, 0.001);
    EXPECT_NEAR(extent_of(load_mesh(path, LengthUnit::kCentimetre).mesh).diameter_m(), 2.95, 0.01);
    EXPECT_NEAR(extent_of(load_mesh(path, LengthUnit::kInch).mesh).diameter_m(), 2.95 * 2.54, 0.03);
    expect_error<std::runtime_error>([&] { load_mesh(path, LengthUnit::kMetre); },
                                     "part of 295 metres, larger than 20 m: the file is probably in millimetres");
    expect_error<std::runtime_error>([&] { load_mesh(path, LengthUnit::kMetre); }, "say --unit mm");

    save_ply(part, path, LengthUnit::kMetre);
    expect_error<std::runtime_error>([&] { load_mesh(path, LengthUnit::kMillimetre); }, "say --unit m");
    MeshLimits limits;
    limits.min_diameter_m = 1e-5;
    EXPECT_NO_THROW(load_mesh(path, LengthUnit::kMillimetre, limits));
}

TEST_F(MeshLoader, RefusesAPartSoFarFromItsOriginThatItLosesItsShape) {
    for (const float distance_m : {0.0F, 100.0F, 1e4F, 1e6F}) {
        Mesh part = make_box({0.03F, 0.02F, 0.05F});
        for (Eigen::Vector3f& vertex : part.vertices_in_object) vertex += Eigen::Vector3f(distance_m, 0.0F, 0.0F);
        const auto path = folder_ / "part.ply";
        save_ply(part, path, LengthUnit::kMetre);
        if (distance_m <= 100.0F) {
            EXPECT_NEAR(extent_of(load_mesh(path, kUnit).mesh).diameter_m(), 0.1233, 1e-4);
        } else {
            expect_error<std::runtime_error>([&] { load_mesh(path, kUnit); }, "numbers of single precision are ");
            expect_error<std::runtime_error>([&] { load_mesh(path, kUnit); }, "move it to the origin in CAD");
        }
    }
    expect_refused("a.obj", "v 1e9 0 0\nv 1e9 0.1 0\nv 1e9 0 0.1\nf 1 2 3\n", "1e+09 m from its origin");
    // A vertex that no triangle has does not count.
    expect_cube("b.obj", obj_cube("") + "v 1e9 0 0\n");
}

TEST(LengthUnit, ParsesItsNames) {
    EXPECT_EQ(parse_length_unit("m"), LengthUnit::kMetre);
    EXPECT_EQ(parse_length_unit("millimetre"), LengthUnit::kMillimetre);
    EXPECT_EQ(parse_length_unit("in"), LengthUnit::kInch);
    for (const LengthUnit unit :
         {LengthUnit::kMetre, LengthUnit::kMillimetre, LengthUnit::kCentimetre, LengthUnit::kInch}) {
        EXPECT_EQ(parse_length_unit(to_string(unit)), unit);
    }
    EXPECT_EQ(metres_per(LengthUnit::kInch), 0.0254);
    expect_error<std::invalid_argument>([] { parse_length_unit("foot"); }, "foot");
}

}  // namespace
}  // namespace nearpose::test
