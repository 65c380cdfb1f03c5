// Exit status, progress and files put in place.
#include "estara/scenes/program.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <csignal>

#include <thread>

#include "files.h"

namespace estara {
namespace {

using test::message_of;
using test::write_file;

/// What f prints to stderr.
template <class F>
std::string printed(F f) {
    ::testing::internal::CaptureStderr();
    f();
    return ::testing::internal::GetCapturedStderr();
}

TEST(RunProgram, PrintsAnErrorOnceAndReturnsItsStatus) {
    int status = -1;
    const auto run = [&](auto body) {
        return printed([&] { status = run_program("estara-bake", body); });
    };
    EXPECT_EQ(run([] {}), "");
    EXPECT_EQ(status, 0);
    EXPECT_EQ(run([] { throw Error("a.glb: bad"); }), "estara-bake: a.glb: bad\n");
    EXPECT_EQ(status, 2);
    EXPECT_EQ(run([] { throw Error("full", ExitStatus::failed); }), "estara-bake: full\n");
    EXPECT_EQ(status, 1);
    EXPECT_EQ(run([] { throw std::bad_alloc(); }), "estara-bake: out of memory\n");
    EXPECT_EQ(status, 1);
    EXPECT_EQ(run([] { throw 5; }), "estara-bake: internal error\n");
    EXPECT_EQ(status, 3);
}

TEST(RunProgram, PutsItsNameBeforeEachOfSeveralProblems) {
    EXPECT_EQ(printed([] { run_program("p", [] { throw Error("one\ntwo"); }); }),
              "p: one\np: two\n");
}

TEST(RunProgram, ClampsTheTextsOfOthers) {
    const std::string text = printed([] {
        run_program("p", [] { throw std::runtime_error("a\nb" + std::string(1000000, 'c')); });
    });
    EXPECT_EQ(text.find("p: internal error: a bccc"), 0u);
    EXPECT_LT(text.size(), 330u);
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
}

TEST(Progress, SaysStartAndEndWithoutATerminal) {
    const std::string text = printed([] {
        Progress progress(ProgressStyle::plain, "baking", 100);
        for (int i = 0; i < 100; ++i) progress.advance(1);
    });
    EXPECT_EQ(text, "baking\nbaking: done in 0.0 s\n");
}

TEST(Progress, SaysNoEndOfWorkThatWasGivenUp) {
    const std::string text = printed([] {
        Progress progress(ProgressStyle::automatic, "baking", 100);  // no terminal here either
        progress.advance(99);
    });
    EXPECT_EQ(text, "baking\n");
}

TEST(Progress, IsSilentIfAskedTo) {
    EXPECT_EQ(printed([] { Progress(ProgressStyle::none, "baking", 1).advance(1); }), "");
}

TEST(Progress, MayBeAdvancedByManyThreads) {
    const std::string text = printed([] {
        Progress progress(ProgressStyle::plain, "baking", 4000);
        std::vector<std::thread> threads;
        for (int t = 0; t < 4; ++t) {
            threads.emplace_back([&] {
                for (int i = 0; i < 1000; ++i) progress.advance(1);
            });
        }
        for (std::thread& thread : threads) thread.join();
    });
    EXPECT_NE(text.find("baking: done in "), std::string::npos);
}

class Pending : public test::InFolder {
protected:
    static std::string contents(const std::string& path) {
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    static int files_here() {
        int count = 0;
        for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(".")) ++count;
        return count;
    }
};

TEST_F(Pending, AppearsUnderItsNameWhenCommitted) {
    write_file("a.exr", "old");
    PendingFile file("a.exr");
    EXPECT_THAT(file.path(), testing::MatchesRegex("\\.a\\.[0-9a-f]+-[0-9a-f]+\\.tmp\\.exr"));
    write_file(file.path(), "new");
    EXPECT_EQ(contents("a.exr"), "old");
    file.commit();
    EXPECT_EQ(contents("a.exr"), "new");
    EXPECT_EQ(files_here(), 1);
}

TEST_F(Pending, LeavesNothingIfGivenUp) {
    write_file("a.exr", "old");
    {
        const PendingFile file("a.exr");
        write_file(file.path(), "half");
    }
    EXPECT_EQ(contents("a.exr"), "old");
    EXPECT_EQ(files_here(), 1);
}

TEST_F(Pending, MakesTheFoldersItNeeds) {
    PendingFile file("frames/left/0001.exr");
    EXPECT_THAT(file.path(),
                testing::MatchesRegex("frames/left/\\.0001\\.[0-9a-f]+-[0-9a-f]+\\.tmp\\.exr"));
    file.commit();
    EXPECT_TRUE(std::filesystem::exists("frames/left/0001.exr"));
}

TEST_F(Pending, LeavesNothingIfInterrupted) {
    const auto interrupted = [] {
        const PendingFile file("a.exr");
        write_file(file.path(), "half");
        std::raise(SIGTERM);
    };
    EXPECT_EXIT(interrupted(), testing::KilledBySignal(SIGTERM), "");
    EXPECT_EQ(files_here(), 0);
}

TEST_F(Pending, OfKilledProgramsAreRemovedAndOthersStay) {
    std::string abandoned;
    const int child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        new PendingFile("b.exr");  // not destroyed
        std::_Exit(0);
    }
    ::waitpid(child, nullptr, 0);
    EXPECT_EQ(files_here(), 1);
    write_file(".b.tmp.exr", "a user's own");
    write_file(".b.0123abcd.tmp.exr", "as well");
    PendingFile held("a.exr");
    EXPECT_EQ(files_here(), 3);  // the abandoned one is gone
    const int other = ::fork();
    ASSERT_GE(other, 0);
    if (other == 0) {
        std::filesystem::create_directory("c");
        std::filesystem::current_path("c");  // another name of the same folder
        const PendingFile beside("../a.exr");
        std::_Exit(std::filesystem::exists("../" + held.path()) ? 0 : 1);
    }
    int status = -1;
    ::waitpid(other, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), 0) << "a live program's file was removed";
    held.write("new");
    held.commit();
    EXPECT_EQ(contents("a.exr"), "new");
}

TEST_F(Pending, SaysWhyItCannotBe) {
    write_file("file", "");
    std::filesystem::create_directory("folder");
    EXPECT_EQ(message_of([] { PendingFile("file/a.exr"); }),
              "file/a.exr: cannot make the folder file: Not a directory");
    EXPECT_EQ(message_of([] { PendingFile("folder"); }),
              "folder: is not a file that can be replaced");
    EXPECT_EQ(message_of([] { PendingFile("/dev/null"); }),
              "/dev/null: is not a file that can be replaced");
    EXPECT_EQ(message_of([] { PendingFile("folder/"); }), "'folder/' is not the name of a file");
    const std::string longest(300, 'a');
    EXPECT_EQ(message_of([&] { PendingFile(longest + ".exr"); }),
              longest + ".exr: cannot write to the folder .: File name too long");
}

TEST_F(Pending, FailsIfItsFileIsGone) {
    PendingFile file("a.exr");
    std::filesystem::remove(file.path());
    try {
        file.commit();
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "a.exr: cannot be written: No such file or directory");
        EXPECT_EQ(error.status(), ExitStatus::failed);
    }
    EXPECT_FALSE(std::filesystem::exists("a.exr"));
}

}  // namespace
}  // namespace estara
