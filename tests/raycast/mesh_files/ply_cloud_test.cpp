// PLY files without faces, which are dense clouds, and PLY files that are written and read again.
#include <cmath>

#include "raycast/mesh_loader.hpp"
#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

std::string ascii_header(const std::string& elements) {
    return "ply\nformat ascii 1.0\n" + elements + "end_header\n";
}

// Points of a sphere in golden-angle order, some with normals.
std::string sphere_cloud(int count, bool normals) {
    std::string text = ascii_header("element vertex " + std::to_string(count) +
                                    "\nproperty float x\nproperty float y\nproperty float z\n" +
                                    (normals ? "property float nx\nproperty float ny\nproperty float nz\n" : ""));
    for (int i = 0; i < count; ++i) {
        const double z = 1.0 - (2.0 * i + 1.0) / count, radius = std::sqrt(1.0 - z * z), angle = 2.399963 * i;
        const Eigen::Vector3d n(radius * std::cos(angle), radius * std::sin(angle), z);
        for (const double value : {n.x(), n.y(), n.z()}) text += std::to_string(0.1 * value) + " ";
        if (normals) text += std::to_string(n.x()) + " " + std::to_string(n.y()) + " " + std::to_string(n.z());
        text += "\n";
    }
    return text;
}

class PlyCloud : public FolderTest {
  protected:
    LoadedMesh load(const std::string& bytes) const { return load_mesh(write("mesh.ply", bytes), LengthUnit::kMetre); }
    void expect_refused(const std::string& bytes, const std::string& part) const {
        expect_error<std::runtime_error>([&] { load(bytes); }, part);
    }
};

TEST_F(PlyCloud, WithoutFacesIsACloudWithNormalsAndDiscs) {
    for (const bool normals : {true, false}) {
        const Mesh cloud = load(sphere_cloud(3000, normals)).mesh;
        ASSERT_TRUE(cloud.is_cloud());
        ASSERT_EQ(cloud.vertices_in_object.size(), 3000U);
        ASSERT_EQ(cloud.vertex_normals_in_object.size(), 3000U);
        for (std::size_t i = 0; i < 3000; ++i) {
            const float cosine = cloud.vertex_normals_in_object[i].dot(cloud.vertices_in_object[i].normalized());
            ASSERT_GT(std::abs(cosine), 0.995F);  // the sign is free
        }
        const double spacing = 0.1 * std::sqrt(4.0 * M_PI / 3000.0);
        EXPECT_GT(cloud.disc_radius_m, 0.8 * spacing);
        EXPECT_LT(cloud.disc_radius_m, 1.6 * spacing);
    }
    expect_refused(sphere_cloud(4, false), "only 4");
    expect_refused(ascii_header("element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                                "element tristrips 1\nproperty list int int vertex_indices\n") +
                       "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                   "strips");
}

TEST_F(PlyCloud, SavedMeshesAndCloudsComeBackInAnyUnit) {
    Mesh mesh = make_box({0.05F, 0.03F, 0.08F});
    for (const LengthUnit unit : {LengthUnit::kMetre, LengthUnit::kMillimetre, LengthUnit::kInch}) {
        save_ply(mesh, folder_ / "saved.ply", unit);
        const Mesh back = load_mesh(folder_ / "saved.ply", unit).mesh;
        ASSERT_EQ(back.triangles.size(), mesh.triangles.size());
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) {
                const auto& saved = mesh.vertices_in_object[static_cast<std::size_t>(mesh.triangles[t][k])];
                const auto& read = back.vertices_in_object[static_cast<std::size_t>(back.triangles[t][k])];
                ASSERT_LT((saved - read).norm(), 1e-7F);
            }
        }
    }
    const Mesh cloud = load(sphere_cloud(500, true)).mesh;
    save_ply(cloud, folder_ / "cloud.ply", LengthUnit::kMetre);
    const Mesh back = load_mesh(folder_ / "cloud.ply", LengthUnit::kMetre).mesh;
    EXPECT_EQ(back.vertices_in_object, cloud.vertices_in_object);
    EXPECT_THROW(save_ply(mesh, folder_ / "no_such_folder" / "x.ply", LengthUnit::kMetre), std::runtime_error);
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
        EXPECT_EQ(entry.path().extension(), ".ply") << "a temporary file is left over";
    }
}

}  // namespace
}  // namespace nearpose::test
