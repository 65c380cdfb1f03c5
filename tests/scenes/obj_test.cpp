#include <cmath>

#include "estara/scenes/load.h"
#include "files.h"

namespace estara {
namespace {

using test::message_of;
using test::write_file;

class Obj : public test::InFolder {
protected:
    static Mesh read(const std::string& text) {
        write_file("a.obj", text);
        return load_scene("a.obj").objects.at(0).mesh;
    }
    static std::string failure(const std::string& text) {
        return message_of([&] { read(text); });
    }
};

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(Obj, TriangulatesPolygons) {
    EXPECT_EQ(read(square + "f 1 2 3\n").triangles.size(), 1u);
    EXPECT_EQ(read(square + "f 1 2 3 4\n").triangles.size(), 2u);
    // An arrow, whose dent a fan from the first corner would fill.
    const Mesh arrow = read("v -2 -2 0\nv 0 -1 0\nv 2 -2 0\nv 0.5 1.5 0\nv 0 2 0\nf 1 2 3 4 5\n");
    EXPECT_EQ(arrow.triangles.size(), 3u);
    EXPECT_NEAR(area(arrow), 6.5, 1e-6);
}

TEST_F(Obj, CountsNegativeIndicesFromTheEnd) {
    const Mesh mesh = read(square + "f -4 -3 -2\n");
    EXPECT_EQ(mesh.P[mesh.triangles[0].x], glm::vec3(0, 0, 0));
    EXPECT_EQ(mesh.P[mesh.triangles[0].z], glm::vec3(1, 1, 0));
}

TEST_F(Obj, ReadsAnyLineEnd) {
    EXPECT_EQ(read("v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nf 1 2 3\r\n").triangles.size(), 1u);
    EXPECT_EQ(read("v 0 0 0\rv 1 0 0\rv 1 1 0\rf 1 2 3").triangles.size(), 1u);
}

TEST_F(Obj, MakesOneVertexOfEqualCornersAndTwoAtASeam) {
    const std::string uv = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0.5\n";
    const Mesh whole = read(square + uv + "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
    EXPECT_EQ(whole.P.size(), 4u);
    EXPECT_EQ(whole.uv.size(), 4u);
    const Mesh seam = read(square + uv + "f 1/1 2/2 3/3\nf 1/5 3/3 4/4\n");
    EXPECT_EQ(seam.P.size(), 5u);
    EXPECT_EQ(seam.uv[seam.triangles[1].x], glm::vec2(0.5f, 0.5f));
}

TEST_F(Obj, SmoothsAcrossASeamOfTheTexture) {
    const Mesh mesh = read(
        "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\nvt 0 0\nvt 1 1\n"
        "f 1/1 3/1 2/1\nf 1/2 2/2 4/2\n");
    ASSERT_EQ(mesh.P.size(), 6u);
    EXPECT_EQ(mesh.N[mesh.triangles[0].x], mesh.N[mesh.triangles[1].x]);
    EXPECT_NEAR(glm::distance(mesh.N[0], glm::normalize(glm::vec3(1, 0, 1))), 0.0f, 1e-6f);
}

TEST_F(Obj, WeightsSmoothNormalsByAngle) {
    // Two faces meet at a right angle; one of them is cut into two triangles at the shared edge.
    const Mesh mesh = read(
        "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 1 0 1\nv 0 1 0\nv 0 1 1\n"
        "f 1 2 4\nf 1 4 3\nf 1 5 6 2\n");
    for (std::size_t i = 0; i < mesh.P.size(); ++i) {
        if (mesh.P[i] != glm::vec3(0, 0, 0)) continue;
        EXPECT_NEAR(glm::distance(mesh.N[i], glm::normalize(glm::vec3(1, 1, 0))), 0.0f, 1e-6f);
    }
}

TEST_F(Obj, TakesNormalsThatAreThereAndMakesThemUnit) {
    const Mesh mesh = read(square + "vn 0 3 4\nf 1//1 2//1 3//1\n");
    EXPECT_NEAR(glm::distance(mesh.N[0], glm::vec3(0, 0.6f, 0.8f)), 0.0f, 1e-6f);
    const Mesh zero = read(square + "vn 0 0 0\nf 1//1 2//1 3//1\n");
    EXPECT_EQ(zero.N[0], glm::vec3(0, 0, 1));
}

TEST_F(Obj, ReadsWhatPeopleWrite) {
    const Mesh plain = read(square + "f 1 2 3 4\n");
    for (const std::string& text : std::vector<std::string>{
             "\xef\xbb\xbf" + square + "f 1 2 3 4\n", square + "f 1 2 \\\n3 4\n",
             square + "f 1 2 \\\r\n 3 \\\r\n4\r\n", square + "f 1 2 3 4 # a face\n",
             square + "f 1// 2// 3/ 4//\n", "# one \\\n" + square + "f 1 2 3 4\n",
             "v 0 0 0 1\nv 1 0 0 1.0 # w\nv\t1 1 0\n  v 0 1 0\nf 1 2 3 4",
             square + "f 1 2 2 3 4 1\n", square + "vp 0.5\ncstype bezier\nf 1 2 3 4\nl 1 2\n"}) {
        const Mesh mesh = read(text);
        EXPECT_EQ(mesh.P, plain.P) << text;
        EXPECT_EQ(mesh.triangles, plain.triangles) << text;
    }
    // Lines are counted as an editor counts them.
    EXPECT_EQ(failure(square + "f 1 \\\n2 3\nf 1 2 x\n").substr(0, 20), "a.obj: line 7: 'x' i");
}

TEST_F(Obj, CutsConcavePolygonsInside) {
    // A chevron of four corners, whose shorter diagonal lies outside.
    const Mesh chevron = read("v 0 0 0\nv 4 -1 0\nv 1 0 0\nv 4 1 0\nf 1 2 3 4\n");
    EXPECT_NEAR(area(chevron), 1.0, 1e-6);
    // Stars, wound either way and in any plane.
    for (const int corners : {10, 11, 300}) {
        for (const bool backwards : {false, true}) {
            std::string text, face = "f";
            double right = 0.0;
            for (int i = 0; i < corners; ++i) {
                const double angle = 2.0 * 3.141592653589793 * i / corners,
                             next = angle + 2.0 * 3.141592653589793 / corners;
                const double r = i % 2 == 0 ? 2.0 : 0.5,
                             s = i + 1 == corners ? 2.0 : (i % 2 == 0 ? 0.5 : 2.0);
                right += 0.5 * r * s * std::sin(next - angle);
                text += "v " + std::to_string(r * std::cos(angle)) + " " +
                        std::to_string(0.6 * r * std::sin(angle)) + " " +
                        std::to_string(0.8 * r * std::sin(angle)) + "\n";
            }
            for (int i = 0; i < corners; ++i) {
                face += " " + std::to_string(backwards ? corners - i : i + 1);
            }
            const Mesh star = read(text + face + "\n");
            EXPECT_EQ(star.triangles.size(), std::size_t(corners - 2));
            EXPECT_NEAR(area(star), right, 1e-4) << corners;
        }
    }
}

TEST_F(Obj, KeepsEdgesBetweenSmoothingGroupsHard) {
    const std::string roof = "v 0 0 0\nv 0 0 1\nv 1 -1 0\nv -1 -1 0\n";
    const std::string left = "f 1 2 3\n", right = "f 2 1 4\n";
    const auto hard = [](const Mesh& mesh) { return mesh.P.size() == 6; };
    EXPECT_FALSE(hard(read(roof + left + right)));  // nothing is said
    EXPECT_TRUE(hard(read(roof + "s off\n" + left + right)));
    EXPECT_TRUE(hard(read(roof + "s 0\n" + left + right)));
    EXPECT_TRUE(hard(read(roof + "s 1\n" + left + "s 2\n" + right)));
    EXPECT_FALSE(hard(read(roof + "s 3\n" + left + "s 3\n" + right)));
    const Mesh flat = read(roof + "s off\n" + left + right);
    for (std::uint32_t t = 0; t < 2; ++t) {
        const MeshPoint point = mesh_point(flat, t, 0.2f, 0.2f);
        EXPECT_LT(glm::distance(point.N, point.Ng), 1e-6f);
    }
    // Normals that are there count, whatever is said of smoothing.
    EXPECT_EQ(read(roof + "s off\nvn 0 1 0\nf 1//1 2//1 3//1\n").N[0], glm::vec3(0, 1, 0));
}

TEST_F(Obj, MakesObjectsOfObjectsGroupsAndMaterials) {
    write_file("a.mtl", "newmtl clay\nKd 0.5 0.25 0.125\nnewmtl wood.001\nKd 1 0 0\n");
    write_file("a.obj", "mtllib a.mtl\n" + square +
                            "o one\nusemtl wood.001\nf 1 2 3\nusemtl clay\nf 1 3 4\n"
                            "o two\ng part\nusemtl Stone\nf 1 2 4\n"
                            "o one\nusemtl wood.001\nf 2 3 4\n");
    const Scene scene = load_scene("a.obj");
    ASSERT_EQ(scene.objects.size(), 3u);
    EXPECT_EQ(scene.objects[0].name, "one.wood.001");
    EXPECT_EQ(scene.objects[0].shader->info().name, "wood");
    EXPECT_EQ(scene.objects[0].mesh.triangles.size(), 2u);
    EXPECT_EQ(scene.objects[1].name, "one.clay");
    EXPECT_EQ(scene.objects[1].base_color, glm::vec3(0.5f, 0.25f, 0.125f));
    EXPECT_EQ(scene.objects[2].name, "two_part");
    EXPECT_EQ(scene.instances.size(), 3u);
    EXPECT_EQ(scene.warnings,
              std::vector<std::string>{"a.obj: material \"Stone\": wears no shader; its name would "
                                       "have to be \"stone\""});
}

TEST_F(Obj, SaysWhatItDoesNotShow) {
    write_file("a.obj",
               "mtllib ../b.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 1 2 1\n"
               "l 1 2\np 1\ncurv 0 1 1 2\n");
    EXPECT_EQ(load_scene("a.obj").warnings,
              (std::vector<std::string>{
                  "a.obj: material file ../b.mtl: outside the scene's folder; its colours are not "
                  "used",
                  "a.obj: not shown: 1 faces with fewer than three different corners, the first in "
                  "line 6",
                  "a.obj: not shown: 2 lines and points",
                  "a.obj: not shown: 1 curves and curved surfaces",
                  "a.obj: not shown: 1 vertex colours"}));
}

TEST_F(Obj, DoesNotMissAMaterialFile) {
    EXPECT_EQ(read("mtllib gone.mtl\n" + square + "usemtl red\nf 1 2 3\n").triangles.size(), 1u);
}

TEST_F(Obj, NamesTheVertexThatIsNotFinite) {
    EXPECT_EQ(failure("v 0 0 0\nv 1 nan 0\nf 1 2 1\n"),
              "a.obj: line 2: vertex 2: 'nan' is not a finite number");
    EXPECT_EQ(failure("v 0 0 0\nv 1 inf 0\nf 1 2 1\n"),
              "a.obj: line 2: vertex 2: 'inf' is not a finite number");
    EXPECT_EQ(failure("v 0 0 1e60\n"), "a.obj: line 1: vertex 1: '1e60' is not a finite number");
    EXPECT_EQ(failure("v 0 0 x\n"), "a.obj: line 1: vertex 1: 'x' is not a finite number");
    EXPECT_EQ(failure("v 0 0\n"), "a.obj: line 1: vertex 1: 2 numbers, it needs 3");
    EXPECT_EQ(failure(square + "vn 0 0 -nan\n"),
              "a.obj: line 5: normal 1: '-nan' is not a finite number");
    EXPECT_EQ(failure(square + "vt nan\n"),
              "a.obj: line 5: texture coordinate 1: 'nan' is not a finite number");
}

TEST_F(Obj, NamesIndicesThatAreOutOfRange) {
    EXPECT_EQ(failure(square + "f 1 2 3\nf 1 2 9\n"),
              "a.obj: line 6: there is no vertex 9; the file has 4");
    EXPECT_EQ(failure(square + "f 1 2 3 9\n"),
              "a.obj: line 5: there is no vertex 9; the file has 4");
    EXPECT_EQ(failure(square + "f 1 2 -5\n"),
              "a.obj: line 5: there is no vertex -5; the file has 4");
    EXPECT_EQ(failure(square + "vt 0 0\nf 1/1 2/2 3/1\n"),
              "a.obj: line 6: there is no texture coordinate 2; the file has 1");
    EXPECT_EQ(failure(square + "f 1//1 2//1 3//1\n"),
              "a.obj: line 5: there is no normal 1; the file has 0");
    EXPECT_EQ(failure(square + "f 1 2 99999999999\n"),
              "a.obj: line 5: there is no vertex 99999999999; the file has 4");
}

TEST_F(Obj, NamesWhatIsNoCorner) {
    for (const std::string bad : {"0", "a", "1/1/1/1", "1.5", "//"}) {
        EXPECT_EQ(failure(square + "vt 0 0\nvn 0 0 1\nf 1 2 " + bad + "\n"),
                  "a.obj: line 7: '" + bad +
                      "' is not a corner; it is written 1, 1/2, 1//3 or 1/2/3, counting from 1");
    }
}

TEST_F(Obj, SaysThatThereAreNoTriangles) {
    EXPECT_EQ(failure(square), "a.obj: no triangles; it has 4 vertices and no face");
    EXPECT_EQ(failure(square + "f 1 2\nf 3 3 4\n"),
              "a.obj: no triangles; it has 4 vertices and 2 faces with fewer than three different "
              "corners, the first in line 5");
    EXPECT_EQ(failure(""), "a.obj: no triangles; it has 0 vertices and no face");
}

class File : public test::InFolder {};

TEST_F(File, ThatIsMissingIsNamed) {
    EXPECT_EQ(message_of([] { load_scene("gone.obj"); }),
              "gone.obj: cannot be read: No such file or directory");
    std::filesystem::create_directory("folder.obj");
    EXPECT_EQ(message_of([] { load_scene("folder.obj"); }),
              "folder.obj: is a folder; a scene is a file");
}

TEST_F(File, OfAnUnknownKindIsNamed) {
    EXPECT_EQ(message_of([] { load_scene("a.blend"); }),
              "a.blend: unknown kind of file; a scene ends in .gltf, .glb, .obj or .ply");
    EXPECT_EQ(message_of([] { load_scene(""); }),
              ": unknown kind of file; a scene ends in .gltf, .glb, .obj or .ply");
}

TEST_F(File, EndingMayBeInCapitals) {
    write_file("A.OBJ", square + "f 1 2 3\n");
    EXPECT_EQ(load_scene("A.OBJ").objects.at(0).name, "A");
}

TEST_F(File, NameBecomesOneThatGridsCanHave) {
    write_file("my möbel (2).obj", square + "f 1 2 3\n");
    EXPECT_EQ(load_scene("my möbel (2).obj").objects.at(0).name, "my_m__bel__2_");
}

}  // namespace
}  // namespace estara
