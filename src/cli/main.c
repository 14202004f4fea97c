/* The program kage: help, and the choice of the command. */
#include "cli/command.h"

#include <stdio.h>
#include <string.h>

static const char help[] =
    "kage renders shadows of other objects on bump-mapped surfaces (Sumi and Noma's method).\n"
    "\n"
    "  kage render SCENE [options]      render the picture of a scene\n"
    "  kage check SCENE [options]       list what is in a scene, and how steep its bumps are\n"
    "  kage pixel SCENE X,Y [options]   all intermediate values of one pixel, for each method\n"
    "  kage pov SCENE -o FILE [options] write the scene for POV-Ray 3.7\n"
    "  kage view SCENE [options]        look at a scene in a window, and change it; see kage view --help\n"
    "  kage import MODEL -o FILE [options]  write a scene for a model: glTF, OBJ, COLLADA and others\n"
    "  kage methods                     list the methods\n"
    "  kage --help, kage --version\n"
    "\n"
    "Options of all commands but import:\n"
    "  --set PATH=VALUE     change a value of the scene: --set objects.ground.bump.scale=0.1\n"
    "  --size WxH           size of the picture in pixels\n"
    "\n"
    "Options of render:\n"
    "  -o FILE              output file: .png (sRGB) or .exr (linear, with all layers); may be repeated.\n"
    "                       Without it: the scene's name with .png, in this folder. Never one of the scene's files\n"
    "  --overwrite          without -o, also replace a file that kage did not write\n"
    "  --shadow METHOD      where shadow rays start: none, 0, 1, 2, 2+, iter:K, march:N, exact, auto[:E]\n"
    "  --shade PLACE        smooth (at the smooth hit), or shifted: where the shadow rays start\n"
    "  --bump-shadow KIND   the bumps' shadows on their own surface: none, march:N, horizon, exact\n"
    "  --relief             the best picture for its cost: --shadow " KAGE_RELIEF_METHOD
    " --shade shifted --bump-shadow " KAGE_RELIEF_BUMP_SHADOW "\n"
    "  --surface KIND       smooth (bump mapping), or displaced: surfaces that are truly displaced by P\n"
    "  --no-self-shadow     bumped objects cast no shadows\n"
    "  --no-guard           the paper's formulas alone, also where tau leaves the slab between Pmin and Pmax\n"
    "  --aa N               N x N samples a pixel\n"
    "  --aa-threshold T     these only where neighbours differ by more than T (0 to 3, sum of red, green\n"
    "                       and blue as displayed), elsewhere one\n"
    "  --crop X0,Y0,X1,Y1   only this part of the picture, in pixels from the top left, X1 and Y1 exclusive\n"
    "  --layers A,B,...     of an EXR: color, Z, P, N, uw, height, tau, order, visibility (all)\n"
    "  --bits 8|16          of a PNG (8)\n"
    "  --resume             go on with an EXR that was interrupted, from FILE.part; one output\n"
    "  --threads N          number of threads (as many as there are processors)\n"
    "  --stats              time and count each stage\n"
    "  --quiet              no progress bar, no closing line\n"
    "\n"
    "Options of view: those of render that change the scene, and --threads.\n"
    "\n"
    "Options of pov:\n"
    "  -o FILE              output file, a name that ends in .pov\n"
    "  --surface KIND       smooth (without the bumps), or displaced: surfaces that are truly displaced by P\n"
    "  --no-self-shadow     bumped objects cast no shadows\n"
    "  --no-cast            all other objects cast none\n"
    "\n"
    "Options of import:\n"
    "  -o FILE              output file, a name that ends in .yaml\n"
    "  --bump OBJECT=MAP,scale=S[,KEY=VALUE...]  a height map for the objects of this name, which may have * and ?;\n"
    "                       scale: height of white above black; other keys: zero (0.5), sign (up), smooth ...\n"
    "  --camera NAME        this camera of the model (its first)\n"
    "  --up y|z             the model's axis that points up (y)\n"
    "  --brightness X       of all lights together (1)\n"
    "  --overwrite          also replace files that exist\n"
    "  --threads N, --quiet as for render\n"
    "\n"
    "Scene files are described in docs/scene.md, the method in docs/method.md, the export to POV-Ray in\n"
    "docs/povray.md, models in docs/models.md.\n"
    "Exit status: 0; 1 where a picture can't be written; 2 for bad input.\n";

/* Flush stdout. Returns the exit status. */
static int finish(int status)
{
    if (fflush(stdout) == 0 && !ferror(stdout))
        return status;
    usage_error("standard output can't be written");
    return status ? status : EXIT_OUTPUT;
}

static int print_methods(void)
{
    for (int k = 0; k < kage_method_count(); k++)
        printf("%-8s  %s\n", kage_method_get(k).name, kage_method_get(k).text);
    return 0;
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        int command;
        int (*run)(const arguments *a);
    } commands[] = {{"render", COMMAND_RENDER, command_render}, {"check", COMMAND_CHECK, command_check},
                    {"pixel", COMMAND_PIXEL, command_pixel},    {"pov", COMMAND_POV, command_pov},
                    {"import", COMMAND_IMPORT, command_import}, {"view", COMMAND_VIEW, command_view}};
    if (argc < 2) {
        fputs(help, stderr);
        return EXIT_INPUT;
    }
    for (int k = 1; k < argc; k++)
        if (strcmp(argv[k], "--help") == 0 || strcmp(argv[k], "-h") == 0) {
            if (strcmp(argv[1], "view") == 0)
                return command_view_help();
            fputs(help, stdout);
            return finish(0);
        }
    if (strcmp(argv[1], "--version") == 0) {
        printf("kage %s (%s)\n", kage_version(), kage_precision());
        return finish(0);
    }
    if (strcmp(argv[1], "methods") == 0)
        return finish(print_methods());
    for (size_t k = 0; k < sizeof commands / sizeof *commands; k++)
        if (strcmp(argv[1], commands[k].name) == 0) {
            arguments a;
            int status = arguments_read(&a, argc, argv, commands[k].command) ? commands[k].run(&a) : EXIT_INPUT;
            arguments_free(&a);
            return finish(status);
        }
    usage_error("no command '%s', expected render, check, pixel, pov, import, view or methods; see kage --help",
                argv[1]);
    return EXIT_INPUT;
}
