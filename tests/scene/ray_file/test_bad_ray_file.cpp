// Every way in which a file of rays can be wrong: the place, and what to try.
#include <fmt/format.h>

#include "catch.hpp"
#include "scene/ray_file/ray_file_writer.hpp"

namespace test_bad_ray_file {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::ray_file;
using namespace lostbits::scene::test;

namespace {

const std::string head = "ox,oy,oz,dx,dy,dz,cx,cy,cz,radius,hit,t\n", good = "0,0,-5,0,0,1,0,0,0,1,1,4\n";

struct BadFile {
    std::string name, bytes;
    std::string place, remedy;  ///< how the message begins, and part of it
    ReadOptions options = {};
};

/// An array of rays, behind whose numbers each record has so many bytes of no meaning.
std::string padded_npy(const std::string& type) {
    std::string fields;
    for (const char* name : {"ox", "oy", "oz", "dx", "dy", "dz"}) fields += fmt::format("('{}', '<f4'), ", name);
    return to_npy("{'descr': [" + fields + "('', '" + type + "')], 'fortran_order': False, 'shape': (1,), }",
                  std::string(24, 'a'));
}

const std::string list = "ox,oy,oz,dx,dy,dz,hit_index,object,t\n";
const ReadOptions of_mesh{.primitive = Shape::triangle};

const BadFile bad_files[] = {
    {"a.csv", "", "a.csv:1:1:", "names of its columns"},
    {"a.csv", "1,2,3\n", "a.csv:1:1:", "--columns"},
    {"a.csv", "ox;oy;oz\n", "a.csv:1:3:", "commas"},
    {"a.csv", "ox,oy,oz,dx,dy\n", "a.csv:1:1:", "no dz"},
    {"a.csv", "junk\n", "a.csv:1:1:", "the columns are \"junk\"; name ox,oy,oz,dx,dy,dz"},
    {"a.csv", "a,b,c\n", "a.csv:1:1:", "the columns are \"a,b,c\"; name ox,oy,oz,dx,dy,dz"},
    {"a.csv", "ox,oy,oz,dx,dy,dz,cx,cy,cz\n", "a.csv:1:1:", "no radius"},
    {"a.csv", "ox,oy,oz,dx,dy,dz,hit,t\n", "a.csv: no primitive: give one for all rays", "--sphere"},
    {"a.csv", "ox,oy,oz,dx,dy,dz,cx,cy,cz,radius,lox,loy,loz,hix,hiy,hiz\n", "a.csv:1:35:", "one shape"},
    {"a.csv", "ox,oy,oz,dx,dy,dz,cx,cy,cz,radius,ox\n", "a.csv:1:35:", "same meaning"},
    {"a.csv", "ox,oy,oz,dx,dy,dz,cx,cy,cz,radius,hits\n", "a.csv:1:35:", "did you mean \"hit\""},
    {"a.csv", "ox,oy,oz,dx,dy,dz,cx,cy,cz,raduis,hit\n", "a.csv:1:28:", "did you mean \"radius\""},
    {"a.csv", "ox,oy,oz,dx,dy,dz,tmin,t_min,cx,cy,cz,radius,hit\n", "a.csv:1:24:", "same meaning"},
    {"a.csv", "ox,oy,oz,dx,dy,dz,tmin\n0,0,-5,0,0,1,-1\n", "a.csv:2:14:", "looks ahead", {.primitive = Shape::sphere}},
    {"a.csv", head + good + "0,0,-5,0,0,1,0,0,0,1,1\n", "a.csv:3:1:", "11 cells, but the header has 12 columns"},
    {"a.csv", head + good + "0,0,-5,0,0,1,0,0,0,1,1,4,5\n", "a.csv:3:1:", "13 cells"},
    {"a.csv", head + "0,0,-5,0,0,1,0,0,0,1,1,four\n", "a.csv:2:24:", "\"four\" is not a number"},
    {"a.csv", head + "0,0,-5,0,0,1,0,0,0,1,yes,4\n", "a.csv:2:22:", "write 1, 0, true or false"},
    {"a.csv", head + "nan,0,-5,0,0,1,0,0,0,1,1,4\n", "a.csv:2:1:", "ox is nan"},
    {"a.csv", head + "0,0,-5,0,inf,1,0,0,0,1,1,4\n", "a.csv:2:10:", "dy is inf"},
    {"a.csv", head + "0,,-5,0,0,1,0,0,0,1,1,4\n", "a.csv:2:3:", "oy is empty"},
    {"a.csv", head + "0,0,-5,0,0,0,0,0,0,1,1,4\n", "a.csv:2:8:", "not a ray"},
    {"a.csv", head + "0,0,-5,0,0,1,0,0,0,0,1,4\n", "a.csv:2:20:", "greater than 0"},
    {"a.csv", head + "0,0,-5,0,0,1,0,0,0,1,2,4\n", "a.csv:2:22:", "write 1 for a hit"},
    {"a.csv", head + "0,0,-5,0,0,1,0,0,0,1,,4\n", "a.csv:2:22:", "write 1 for a hit"},
    {"a.csv", head + "0,0,-5,0,0,1,0,0,0,1,1,\n", "a.csv:2:24:", "t is empty"},
    {"a.csv", head + "0,0,-5,0,0,1e39,0,0,0,1,1,4\n", "a.csv:2:12:", "--answer-format", {.format = find_format("f32")}},
    {"a.csv", head + "0,\"0,-5,0,0,1,0,0,0,1,1,4\n", "a.csv:2:3:", "does not close it"},
    {"a.csv", head + "0,0\"0,-5,0,0,1,0,0,0,1,1,4\n" + good, "a.csv:2:3:", "quote"},
    {"a.csv",
     "ox,oy,oz,dx,dy,dz,hit,t,object\n0,0,-5,0,0,1,1,4,1e30\n",
     "a.csv:2:18: object is 1e+30",
     "from 0",
     {.primitive = Shape::sphere}},
    {"a.csv", head + good, "a.csv: --miss", "leave --miss out", {.miss = MissRule{MissRule::Kind::never}}},
    {"a.csv", head + good, "a.csv: its columns have a primitive", "leave one", {.primitive = Shape::box}},
    {"a.csv", "ox,oy,oz,dx,dy,dz,t\n0,0,-5,0,0,1,-1\n", "a.csv:2:14:", "--miss -1", {.primitive = Shape::sphere}},
    {"a.csv", "ox,oy,oz,dx,dy,dz,tmin\n0,0,-5,0,0,1,inf\n", "a.csv:2:14:", "finite", {.primitive = Shape::box}},
    {"a.csv", "ox,oy,oz,dx,dy,dz,tmax\n0,0,-5,0,0,1,nan\n", "a.csv:2:14:", "inf", {.primitive = Shape::box}},
    {"a.csv",
     "ox,oy,oz,dx,dy,dz,tmin,tmax\n0,0,-5,0,0,1,4,5\n0,0,-5,0,0,1,4,3\n",
     "a.csv:3:16: tmax is 3",
     "begins at tmin = 4 and ends at tmax = 3, and no t lies between",
     {.primitive = Shape::sphere}},
    {"a.csv", "ox,oy,oz,dx,dy,dz,tmax\n0,0,-5,0,0,1,-1\n", "a.csv:2:14:", "no t lies", {.primitive = Shape::sphere}},
    {"a.csv",
     "ox,oy,oz,dx,dy,dz,tmin,tmax\n0,0,-5,0,0,1,4,4\n",
     "a.csv:2:16:",
     "no t lies between",
     {.primitive = Shape::sphere, .open_ends = {.tmin = true}}},
    {"a.csv",
     "ox,oy,oz,dx,dy,dz,hit,t,object\n0,0,-5,0,0,1,1,4,-1\n",
     "a.csv:2:18: object is -1",
     "hit says that the ray hits; write the number of the primitive",
     {.primitive = Shape::sphere}},
    {"a.csv",
     "ox,oy,oz,dx,dy,dz,t,object\n0,0,-5,0,0,1,4,\n",
     "a.csv:2:16: object is empty",
     "t says that the ray hits",
     {.primitive = Shape::sphere}},
    {"a.csv", "ox,oy,oz,dx,dy,dz,lox,loy,loz,hix,hiy,hiz\n0,0,-5,0,0,1,0,2,0,1,1,1\n", "a.csv:2:16:", "lo <= hi"},
    {"a.csv", list + "0,0,-5,0,0,1,0,0,4\n0,0,-5,0,0,1,2,1,6\n", "a.csv:3:14: hit_index is 2",
     "the hit_index before it is 0", of_mesh},
    {"a.csv", list + "0,0,-5,0,0,1,0,0,4\n0,1,-5,0,0,1,1,1,6\n", "a.csv:3:14: hit_index is 1", "another ray", of_mesh},
    {"a.csv", list + "0,0,-5,0,0,1,0.5,0,4\n", "a.csv:2:14: hit_index is 0.5", "0 for the first hit", of_mesh},
    {"a.csv", list + "0,0,-5,0,0,1,0,-1,4\n", "a.csv:2:16: hit_index is 0", "number of the triangle", of_mesh},
    {"a.csv", list + "0,0,-5,0,0,1,-1,2,4\n", "a.csv:2:14: hit_index says that the ray has no hit", "object is 2",
     of_mesh},
    {"a.csv", list + "0,0,-5,0,0,1,0,0,\n", "a.csv:2:18: t is empty", "nan if it is not", of_mesh},
    {"a.csv", "ox,oy,oz,dx,dy,dz,hit_index,t\n", "a.csv:1:19: \"hit_index\" counts the hits", "add object", of_mesh},
    {"a.csv", "ox,oy,oz,dx,dy,dz,hit_idnex,object,t\n", "a.csv:1:19:", "did you mean \"hit_index\"", of_mesh},
    {"a.csv", "ox,oy,oz,dx,dy,dz,crosings\n", "a.csv:1:19:", "did you mean \"crossings\"", of_mesh},
    {"a.csv", "ox,oy,oz,dx,dy,dz,partiy\n", "a.csv:1:19:", "did you mean \"parity\"", of_mesh},
    {"a.csv", "px,py,pz,insid\n", "a.csv:1:10:", "did you mean \"inside\"", of_mesh},
    {"a.csv", "ox,oy,oz,dx,dy,dz,crossings,parity\n", "a.csv:1:29: \"crossings\" and \"parity\"", "leave one", of_mesh},
    {"a.csv", "ox,oy,oz,dx,dy,dz,crossings,cx,cy,cz,radius\n", "a.csv:1:1: \"crossings\" is about", "a primitive"},
    {"a.csv", "ox,oy,oz,dx,dy,dz,crossings\n0,0,-5,0,0,1,-2\n", "a.csv:2:14: crossings is -2", "from 0", of_mesh},
    {"a.csv", "ox,oy,oz,dx,dy,dz,parity\n0,0,-5,0,0,1,2\n", "a.csv:2:14: parity is 2", "odd number", of_mesh},
    {"a.csv", "px,py,inside\n", "a.csv:1:1: a point has no pz", "px,py,pz,inside", of_mesh},
    {"a.csv", "px,py,pz,inside\n0,0,inf,1\n", "a.csv:2:5: pz is inf", "three finite numbers", of_mesh},
    {"a.csv", "px,py,pz,inside\n0,0,0,\n", "a.csv:2:7: inside is empty", "1 for a point inside", of_mesh},
    {"a.csv", "ox,oy,oz,dx,dy,dq\n", "a.csv:1:16: a ray has no dz", "is \"dq\" meant to be \"dz\"?"},
    {"a.csv", "dq\n", "a.csv:1:1: a ray has no ox, oy, oz, dx, dy, dz", "the columns are \"dq\""},
    {"a.csv", "ox," + std::string(3 << 20, 'x'), "a.csv:1:1:", "million"},
    {"a.dat", "", "a.dat: is not a known kind of file; use .csv or .npy", "--columns"},
    {"a.bin",
     "12345678901",
     "a.bin: record 0: has 11 of 24 bytes",
     "cut short",
     {.columns = "ox:f32,oy,oz,dx,dy,dz", .primitive = Shape::sphere}},
    {"a.bin", "", "--columns: ox: \"g32\"", "f16", {.columns = "ox:g32"}},
    {"a.bin", "", "--columns: ox has no type", "ox:f32", {.columns = "ox,oy"}},
    {"a.bin", "", "--columns: a name is missing", "_ for", {.columns = "ox:f32,,oz"}},
    {"a.bin",
     std::string(24, '\0'),
     "a.bin: record 0: the direction is 0,0,0",
     "not a ray",
     {.columns = "ox:f32,oy,oz,dx,dy,dz", .primitive = Shape::sphere}},
    {"a.npy", "no array at all", "a.npy: is not an array", "numpy.save"},
    {"a.npy", "\x93NUMPY\x01", "a.npy: ends inside its header", "cut short"},
    {"a.npy", to_npy("{'descr': '<c8', 'fortran_order': False, 'shape': (1, 6), }", ""), "a.npy: is of type \"<c8\"",
     "astype"},
    {"a.npy", to_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 6), }", ""),
     "a.npy: has 6 columns without names", "--columns"},
    {"a.npy",
     to_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 6), }", std::string(24, 'a')),
     "a.npy: record 1: has 0 of 24",
     "the header promises 2 records",
     {.columns = "ox,oy,oz,dx,dy,dz", .primitive = Shape::sphere}},
    {"a.npy",
     to_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 6), }", std::string(25, 'a')),
     "a.npy: byte",
     "the header promises 1 record, but 1 more byte follows",
     {.columns = "ox,oy,oz,dx,dy,dz", .primitive = Shape::sphere}},
    {"a.npy",
     to_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 6), }", std::string(24, 'a')),
     "a.npy: has 6 columns, but --columns names 2",
     "_ for",
     {.columns = "ox,oy"}},
    {"a.npy",
     to_npy("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 6), }", std::string(24, 'a')),
     "a.npy: has 24 bytes of numbers, but its header promises 2",
     "cut short",
     {.columns = "ox,oy,oz,dx,dy,dz", .primitive = Shape::sphere}},
    {"a.npy", to_npy("{'descr': '<f4', 'shape': (1, 6), }", ""), "a.npy: byte", "missing"},
    // Sizes that leave 64 bits: the offsets of the columns would lie beyond the record.
    {"a.npy", padded_npy("|V18446744073709551596"), "a.npy: its records have more than 1048576 bytes", "only"},
    {"a.npy", padded_npy("|V4294967296', (4294967296, 1)), ('y', '|V4"), "a.npy: its records have more", "only"},
    {"a.npy", padded_npy("|V2000000"), "a.npy: its records have more than 1048576 bytes", "only"},
};

}  // namespace

TEST_CASE("a bad file of rays is refused with its line and advice") {
    for (const BadFile& bad : bad_files) {
        const std::string fault = fault_of(bad.name, bad.bytes, bad.options);
        INFO(bad.bytes.substr(0, 200) << "\n" << fault);
        CHECK(fault.starts_with(bad.place));
        CHECK(has(fault, bad.remedy));
    }
    CHECK(fault_of("a.csv", head + good).empty());
}

TEST_CASE("a cell of many lines is read in time proportional to its bytes") {
    // Half a million lines in one cell: counting its quotes anew at each of them takes a minute.
    const std::string many(500'000, '\n');
    CHECK(fault_of("a.csv", "note," + head + "\"" + many + "\"," + good).empty());
    const std::string after = "note," + head + "\"" + many + "\"," + good + "x\n";
    CHECK(fault_of("a.csv", after).starts_with("a.csv:500003:1:"));
}

}  // namespace test_bad_ray_file
