#include <algorithm>
#include <cstring>

#include "estara/scenes/load.h"
#include "files.h"

namespace estara {
namespace {

using test::message_of;
using test::write_file;

class Ply : public test::InFolder {
protected:
    static Mesh read(const std::string& text) {
        write_file("a.ply", text);
        return load_scene("a.ply").objects.at(0).mesh;
    }
    static std::string failure(const std::string& text) {
        return message_of([&] { read(text); });
    }
};

const std::string ascii = "ply\nformat ascii 1.0\n";
const std::string four_vertices =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
const std::string one_face = "element face 1\nproperty list uchar int vertex_indices\n";

/// Bytes of a value, in either order.
template <class T>
std::string bytes_of(T value, bool little) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    if (!little) std::reverse(bytes.begin(), bytes.end());
    return bytes;
}

TEST_F(Ply, ReadsTextAndFansPolygons) {
    const Mesh mesh =
        read(ascii + four_vertices + one_face + "end_header\n" + square + "4 0 1 2 3\n");
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.triangles[0], glm::uvec3(0, 1, 2));
    EXPECT_EQ(mesh.triangles[1], glm::uvec3(0, 2, 3));
    EXPECT_EQ(mesh.P[2], glm::vec3(1, 1, 0));
    EXPECT_EQ(mesh.N[2], glm::vec3(0, 0, 1));
    EXPECT_FALSE(mesh.has_uv());
}

TEST_F(Ply, ReadsBinaryOfBothOrdersAndAllTypes) {
    for (const bool little : {true, false}) {
        std::string file = std::string("ply\r\nformat binary_") + (little ? "little" : "big") +
                           "_endian 1.0\r\ncomment made by hand\r\nelement vertex 3\r\n"
                           "property double x\r\nproperty float32 y\r\nproperty int16 z\r\n"
                           "property uint8 red\r\nproperty list ushort int8 extra\r\n"
                           "element edge 1\r\nproperty int vertex1\r\n"
                           "element face 1\r\nproperty list uint16 uint vertex_index\r\n"
                           "end_header\n";
        const float x[] = {0, 1.5f, 0}, y[] = {0, 0, 2.25f};
        for (int i = 0; i < 3; ++i) {
            file += bytes_of(double(x[i]), little) + bytes_of(y[i], little) +
                    bytes_of(std::int16_t(-7), little) + '\xff' +
                    bytes_of(std::uint16_t(2), little) + "ab";
        }
        file += bytes_of(std::int32_t(1), little);
        file += bytes_of(std::uint16_t(3), little);
        for (const std::uint32_t v : {0u, 1u, 2u}) file += bytes_of(v, little);
        const Mesh mesh = read(file);
        ASSERT_EQ(mesh.triangles.size(), 1u);
        EXPECT_EQ(mesh.P[1], glm::vec3(1.5f, 0, -7));
        EXPECT_EQ(mesh.P[2], glm::vec3(0, 2.25f, -7));
    }
}

TEST_F(Ply, ReadsNormalsAndTextureCoordinatesUnderTheirNames) {
    for (const auto& [u, v] :
         {std::pair("u", "v"), std::pair("s", "t"), std::pair("texture_u", "texture_v")}) {
        const Mesh mesh = read(
            ascii + "element vertex 3\nproperty float nx\nproperty float ny\nproperty float nz\n" +
            "property float x\nproperty float y\nproperty float z\nproperty float " + u +
            "\nproperty float " + v + "\n" + one_face +
            "end_header\n0 2 0 0 0 0 0.1 0.2\n0 0 0 1 0 0 0.3 0.4\n1 0 0 0 1 0 0.5 0.6\n3 0 1 2\n");
        EXPECT_EQ(mesh.uv.at(1), glm::vec2(0.3f, 0.4f));
        EXPECT_EQ(mesh.N.at(0), glm::vec3(0, 1, 0));
        EXPECT_EQ(mesh.N.at(1), glm::vec3(0, 0, 1));  // it was zero
        EXPECT_EQ(mesh.P.at(2), glm::vec3(0, 1, 0));
    }
}

TEST_F(Ply, WindsEverySecondTriangleOfAStripTheOtherWay) {
    const Mesh mesh =
        read(ascii + "element vertex 6\nproperty float x\nproperty float y\n" +
             "property float z\nelement tristrips 1\n" +
             "property list int int vertex_indices\nend_header\n" +
             "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n" + "10 0 1 2 3 -1 2 3 4 5 -1\n");
    ASSERT_EQ(mesh.triangles.size(), 4u);
    for (std::uint32_t t = 0; t < 4; ++t) {
        EXPECT_EQ(mesh_point(mesh, t, 0.3f, 0.3f).Ng, glm::vec3(0, 0, 1)) << t;
    }
    EXPECT_DOUBLE_EQ(area(mesh), 2.0);
}

TEST_F(Ply, LeavesOutTheSeamsOfStrips) {
    const Mesh mesh =
        read(ascii + four_vertices + "element tristrips 1\n" +
             "property list int int vertex_indices\nend_header\n" + square + "6 0 1 2 2 3 0\n");
    for (const glm::uvec3& t : mesh.triangles) EXPECT_TRUE(t.x != t.y && t.y != t.z && t.z != t.x);
    EXPECT_EQ(mesh.triangles.size(), 2u);
}

TEST_F(Ply, NamesTheVertexThatIsNotFinite) {
    EXPECT_EQ(failure(ascii + four_vertices + one_face +
                      "end_header\n0 0 0\n1 nan 0\n1 1 0\n0 1 0\n3 0 1 2\n"),
              "a.ply: vertex 2 of 4: y is nan, not a finite number");
    EXPECT_EQ(failure(ascii + four_vertices + one_face +
                      "end_header\n0 0 0\n1 0 -inf\n1 1 0\n0 1 0\n3 0 1 2\n"),
              "a.ply: vertex 2 of 4: z is -inf, not a finite number");
}

TEST_F(Ply, NamesIndicesThatAreOutOfRange) {
    const std::string head = ascii + four_vertices + one_face + "end_header\n" + square;
    EXPECT_EQ(failure(head + "3 0 1 4\n"),
              "a.ply: face 1 of 1: there is no vertex 4; the file has 4, counted from 0");
    EXPECT_EQ(failure(head + "3 0 -1 2\n"),
              "a.ply: face 1 of 1: there is no vertex -1; the file has 4, counted from 0");
    EXPECT_EQ(failure(head + "3 0 1.5 2\n"),
              "a.ply: face 1 of 1: there is no vertex 1.5; the file has 4, counted from 0");
    EXPECT_EQ(failure(head + "3 0 nan 2\n"),
              "a.ply: face 1 of 1: there is no vertex nan; the file has 4, counted from 0");
}

TEST_F(Ply, NamesWhereATruncatedFileEnds) {
    const std::string head = ascii + four_vertices + one_face + "end_header\n";
    EXPECT_EQ(failure(head + square + "3 0 1\n"),
              "a.ply: face 1 of 1: the file ends here; is it truncated?");
    EXPECT_EQ(failure(head + "0 0 0\n1 0 0\n"),
              "a.ply: 4 of 'vertex' do not fit into the 12 bytes left; is the file truncated?");
    EXPECT_EQ(failure(ascii + four_vertices),
              "a.ply: line 7: the header has no end ('end_header')");
    EXPECT_EQ(failure(head + square + "-3 0 1 2\n"),
              "a.ply: face 1 of 1: -3 is not the length of a list");
}

TEST_F(Ply, DoesNotBelieveHugeCounts) {
    const std::string binary = "ply\nformat binary_little_endian 1.0\n";
    EXPECT_EQ(failure(binary + "element vertex 18446744073709551615\nproperty float x\n" +
                      "property float y\nproperty float z\nend_header\n"),
              "a.ply: 18446744073709551615 of 'vertex' do not fit into the 0 bytes left; is the "
              "file truncated?");
    EXPECT_EQ(failure(binary + "element vertex 0\nproperty float x\nproperty float y\n" +
                      "property float z\nelement face 1\nproperty list uint int vertex_indices\n" +
                      "end_header\n\xff\xff\xff\xff"),
              "a.ply: face 1 of 1: a list of 4294967295 does not fit into the 0 bytes left; is the "
              "file truncated?");
    EXPECT_EQ(failure(binary + "element vertex 0\nproperty float x\nproperty float y\n" +
                      "property float z\nelement nothing 18446744073709551615\nend_header\n"),
              "a.ply: no triangles; it has 0 vertices");
}

TEST_F(Ply, SaysWhatIsWrongWithTheHeader) {
    EXPECT_EQ(failure("solid\n"), "a.ply: not a PLY file; it does not begin with 'ply'");
    EXPECT_EQ(failure(""), "a.ply: line 1: the header has no end ('end_header')");
    EXPECT_EQ(failure("ply\nformat binary 1.0\n"),
              "a.ply: line 2: format 'binary'; there are ascii, binary_little_endian and "
              "binary_big_endian");
    EXPECT_EQ(failure("ply\nformat ascii 2.0\n"), "a.ply: line 2: version '2.0'; this reads 1.0");
    EXPECT_EQ(failure("ply\nend_header\n"), "a.ply: line 2: no 'format' line");
    EXPECT_EQ(failure(ascii + "property float x\n"),
              "a.ply: line 3: a property before the first element");
    EXPECT_EQ(failure(ascii + "element vertex -4\n"),
              "a.ply: line 3: '-4' is not a number of elements");
    EXPECT_EQ(failure(ascii + four_vertices + "element vertex 4\n"),
              "a.ply: line 7: a second element 'vertex'");
    EXPECT_EQ(failure(ascii + "element vertex 4\nproperty half x\n"),
              "a.ply: line 4: unknown type 'half'; there are char, uchar, short, ushort, int, "
              "uint, float, double");
    EXPECT_EQ(failure(ascii + "element vertex 4\nproperty float\n"),
              "a.ply: line 4: a property without a name");
    EXPECT_EQ(failure(ascii + "elephant\n"),
              "a.ply: line 3: 'elephant' is none of format, element, property, comment");
    EXPECT_EQ(failure(ascii + "element vertex 1\nproperty float x\nend_header\n1\n"),
              "a.ply: its vertices have no x, y and z");
    EXPECT_EQ(failure(ascii + four_vertices + "end_header\n" + square),
              "a.ply: no triangles; it has 4 vertices");
    EXPECT_EQ(failure(ascii + four_vertices + "end_header\n0 0 x 0 0 0 0 0 0 0 0 0\n"),
              "a.ply: vertex 1 of 4: 'x' is not a number");
}

TEST_F(Ply, CutAnywhereFailsCleanly) {
    std::string file =
        "ply\nformat binary_little_endian 1.0\n" + four_vertices + one_face + "end_header\n";
    for (const float v : {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) file += bytes_of(v, true);
    file += '\4';
    for (const std::int32_t v : {0, 1, 2, 3}) file += bytes_of(v, true);
    EXPECT_EQ(read(file).triangles.size(), 2u);
    for (std::size_t size = 0; size < file.size(); ++size) {
        const std::string message = failure(file.substr(0, size));
        EXPECT_EQ(message.find("a.ply: "), 0u) << size << ": " << message;
    }
}

TEST_F(Ply, CutsConcavePolygonsInside) {
    const std::string header =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    const std::string chevron = "0 0 0\n4 -1 0\n1 0 0\n4 1 0\n";
    EXPECT_NEAR(area(read(header + chevron + "4 0 1 2 3\n")), 1.0, 1e-6);
    EXPECT_NEAR(area(read(header + chevron + "4 3 2 1 0\n")), 1.0, 1e-6);
}

TEST_F(Ply, ReadsFacesBeforeVerticesMarksAndOldLineEnds) {
    const std::string text =
        "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\n"
        "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
        "property uchar red\nend_header\n5 0 1 1 2 3\n0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n";
    EXPECT_NEAR(area(read(text)), 1.0, 1e-6);
    EXPECT_NEAR(area(read("\xef\xbb\xbf" + text)), 1.0, 1e-6);
    std::string old = text;
    std::replace(old.begin(), old.end(), '\n', '\r');
    EXPECT_NEAR(area(read(old)), 1.0, 1e-6);
    write_file("a.ply", text);
    EXPECT_EQ(load_scene("a.ply").warnings,
              std::vector<std::string>{"a.ply: not shown: colours of the element 'vertex'"});
}

}  // namespace
}  // namespace estara
