// Enters the faces of a file into a mesh, as triangles.
#pragma once

#include <string>
#include <vector>

#include "raycast/mesh_loader.hpp"

namespace nearpose {

class FaceWriter {
  public:
    // `source` names the file in errors. All must live longer.
    FaceWriter(const std::string& source, const MeshLimits& limits, Mesh& mesh, MeshRepair& repair)
        : source_(source), limits_(limits), mesh_(mesh), repair_(repair) {}

    // A polygon over vertices that may follow later; counted as degenerate where it has fewer than three corners. A
    // corner that does not exist is any other number. Throws std::runtime_error where the mesh would pass the limit.
    void add(const std::vector<int>& corners);

    // Once all vertices are there: divides the polygons that are not convex. Throws std::runtime_error where that would
    // take minutes.
    void finish();

  private:
    struct Polygon {
        int first_triangle;
        int num_corners;
    };

    const std::string& source_;
    const MeshLimits& limits_;
    Mesh& mesh_;
    MeshRepair& repair_;
    std::vector<Polygon> polygons_;  // of four corners and more, in `mesh_` as fans from their first corner
};

}  // namespace nearpose
