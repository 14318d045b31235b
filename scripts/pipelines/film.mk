# Pattern rules from frames of a volume to a film, one output a rule:
#
#   X.t4h                   the hypermesh of the isosurface of FRAMES at ISO
#   X.t4d                   its dynamic triangles, what the player draws
#   X/contact-sheet.png     the film at TIMES as X/frames/00000.png ..., and TILES of its pictures on one sheet
#   X/film.y4m              the same film as one file
#   X/slices/slices.pvd     the surface at SLICE_TIMES as VTP files and their index
#
#   make -f film.mk FRAMES_DIR=simulation ISO=0.5 out/splash/contact-sheet.png
#
# Include it in a makefile of your own to extend it. Times are A:B:STEP in the unit of the frames' headers, or with an f
# after each number in frames: 0f:20f:0.25f is slow motion. Without TIMES there is one picture a frame.
#
# A target is made again when its inputs, the program that makes it, or the options it was made with have changed; the
# options stand beside it in TARGET.options.

TET4D_BIN   ?=
FRAMES_DIR  ?= .
FRAMES      ?= $(sort $(wildcard $(FRAMES_DIR)/*.nrrd $(FRAMES_DIR)/*.nhdr))
ISO         ?= 0.5
TIMES       ?=
SLICE_TIMES ?= $(TIMES)
SIZE        ?= 960x540
COLUMNS     ?= 6
TILES       ?= 24
CAMERA      ?=
MC_FLAGS    ?=
PLAY_FLAGS  ?=
QUIET       ?= -q

tet4d_program = $(if $(TET4D_BIN),$(TET4D_BIN:%/=%)/)$(1)
tet4d_view    = --offscreen --size $(SIZE) $(if $(TIMES),--times $(TIMES)) $(if $(CAMERA),--camera $(CAMERA)) $(PLAY_FLAGS)

# A program given by TET4D_BIN is a prerequisite; one found on the PATH is taken as it is.
tet4d_maker   = $(if $(TET4D_BIN),$(call tet4d_program,$(1)))
# Writes $(1) to the target unless it says so already, so that its time tells when the options changed.
tet4d_remember = @mkdir -p $(@D) && printf '%s\n' '$(subst ','\'',$(1))' | cmp -s - $@ || printf '%s\n' '$(subst ','\'',$(1))' > $@

.DELETE_ON_ERROR:
# Hypermeshes are worth keeping: the next film starts from them.
.SECONDARY:
.PHONY: tet4d_always
tet4d_always:

%.t4h.options: tet4d_always
	$(call tet4d_remember,$(FRAMES) --iso $(ISO) $(MC_FLAGS))

%/contact-sheet.png.options: tet4d_always
	$(call tet4d_remember,$(tet4d_view) --columns $(COLUMNS) --tiles $(TILES))

%/film.y4m.options: tet4d_always
	$(call tet4d_remember,$(tet4d_view))

%/slices.pvd.options: tet4d_always
	$(call tet4d_remember,$(SLICE_TIMES))

%.t4h: $(FRAMES) %.t4h.options $(call tet4d_maker,tet4d-mc)
	$(if $(FRAMES),,$(error no frames: set FRAMES, or FRAMES_DIR to a folder of .nrrd files))
	@mkdir -p $(@D)
	@echo "$(call tet4d_program,tet4d-mc) $(firstword $(FRAMES)) ... ($(words $(FRAMES)) frames) --iso $(ISO) $(MC_FLAGS) -o $@"
	@$(call tet4d_program,tet4d-mc) $(FRAMES) --iso $(ISO) $(MC_FLAGS) $(QUIET) --force --depfile $@.d -o $@

%.t4d: %.t4h $(call tet4d_maker,dyntri-build)
	$(call tet4d_program,dyntri-build) $< $(QUIET) --force --depfile $@.d -o $@

%/contact-sheet.png: %.t4d $(CAMERA) %/contact-sheet.png.options $(call tet4d_maker,tet4d-play)
	@mkdir -p $*/frames && rm -f $*/frames/[0-9]*.png
	$(call tet4d_program,tet4d-play) $< $(tet4d_view) $(QUIET) --force -o $*/frames/%05d.png \
	  --contact-sheet $@ --columns $(COLUMNS) --tiles $(TILES)

%/film.y4m: %.t4d $(CAMERA) %/film.y4m.options $(call tet4d_maker,tet4d-play)
	@mkdir -p $(@D)
	$(call tet4d_program,tet4d-play) $< $(tet4d_view) $(QUIET) --force --format y4m -o $@

%/slices/slices.pvd: %.t4h %/slices/slices.pvd.options $(call tet4d_maker,tet4d-convert)
	@mkdir -p $(@D)
	$(if $(SLICE_TIMES),,$(error set SLICE_TIMES, such as 0f:20f:1f))
	$(call tet4d_program,tet4d-convert) $< --times $(SLICE_TIMES) $(QUIET) --force --depfile $@.d -o $@

# What the programs read beside the files named above (the data of detached headers), from the last run.
tet4d_stems = $(basename $(filter %.t4h %.t4d,$(MAKECMDGOALS))) \
  $(foreach end,/contact-sheet.png /film.y4m /slices/slices.pvd,$(patsubst %$(end),%,$(filter %$(end),$(MAKECMDGOALS))))
-include $(wildcard $(foreach stem,$(sort $(tet4d_stems)),$(stem).t4h.d $(stem).t4d.d))
