!> Discrete elements in space: a model behind a handle, built in steps, run, and read.
!>
!> create, laws, settings; then run as often as wanted; then summary, bodies and history tell the last run. A run
!> that pauses goes on with go_on; its state can be kept, and taken back by resume.
!> Body numbers are 1-based; mass 0 marks a support.
module api_dem3
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: create, laws, settings, run, go_on, state_size, state, resume, summary, bodies, history

contains

   !> Bodies made of convex polyhedra
   subroutine create(nb, npart, nvert, nface, nloop, centroid, axes, mass, parts, vertex, loop_first, loop, handle, &
                     status)
      use common_status, only : status_ok, status_out_of_memory
      use dem3_bodies, only : body_set_new
      use dem3_handle, only : built_solids, built_solids_register
      integer(c_int), intent(in) :: nb                        !! bodies
      integer(c_int), intent(in) :: npart                     !! convex parts
      integer(c_int), intent(in) :: nvert                     !! vertices of all parts
      integer(c_int), intent(in) :: nface                     !! faces of all parts
      integer(c_int), intent(in) :: nloop                     !! vertices of all faces
      real(c_double), intent(in) :: centroid(3, nb)           !! [m]
      real(c_double), intent(in) :: axes(3, 3, nb)            !! columns: principal axes
      real(c_double), intent(in) :: mass(4, nb)               !! [kg], and principal inertia [kg m^2]
      integer(c_int), intent(in) :: parts(3, npart + 1)       !! body, first vertex, first face; last column: ends
      real(c_double), intent(in) :: vertex(3, nvert)          !! in the principal axes of the body [m]
      integer(c_int), intent(in) :: loop_first(nface + 1)     !! first vertex of each face
      integer(c_int), intent(in) :: loop(nloop)               !! vertices of the faces, counter-clockwise from outside
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      integer :: failed
      handle = 0
      status = status_out_of_memory
      allocate (built, stat=failed)
      if (failed /= 0) return
      call body_set_new(centroid, axes, mass(1, :), mass(2:4, :), parts(1, 1:npart), parts(2, :), vertex, parts(3, :), &
         loop_first, loop, built%set, status)
      if (status == status_ok) then
         call built_solids_register(built, handle, status)
      else
         deallocate (built)
      end if
   end subroutine create

   !> Types of joints, the first that of contacts that form later; and pairs of bodies whose joint has another
   subroutine laws(handle, nlaw, law, njoint, joint, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_bad_index, status_invalid_argument, status_out_of_memory
      use dem3_handle, only : built_solids, built_solids_take
      use dem3_law, only : joint_law
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nlaw
      real(c_double), intent(in) :: law(4, nlaw)              !! see joint_law
      integer(c_int), intent(in) :: njoint
      integer(c_int), intent(in) :: joint(3, njoint)          !! two bodies, the lower first, and the law
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      integer :: k, failed
      call built_solids_take(handle, built, status)
      if (status /= status_ok) return
      if (any(joint(1:2, :) < 1) .or. any(joint(1:2, :) > size(built%set%item)) .or. any(joint(3, :) < 1) &
         .or. any(joint(3, :) > nlaw)) then
         status = status_bad_index
      else if (nlaw < 1 .or. .not. all(law(1:2, :) > 0.0_c_double) .or. any(law(3:4, :) < 0.0_c_double)) then
         status = status_invalid_argument
      else
         if (allocated(built%law)) deallocate (built%law)
         if (allocated(built%law_of)) deallocate (built%law_of)
         allocate (built%law(nlaw), built%law_of(3, njoint), stat=failed)
         status = merge(status_ok, status_out_of_memory, failed == 0)
         if (failed == 0) then
            do k = 1, nlaw
               built%law(k) = joint_law(law(1, k), law(2, k), law(3, k), law(4, k))
            end do
            built%law_of(:, :) = joint
         end if
      end if
      call handle_leave(handle)
   end subroutine laws

   !> How to run, gravity, the direction of horizontal ground motion, and velocities at the start
   subroutine settings(handle, numbers, settle_steps, at_rest, threads, gravity, way, nb, rate, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument, status_out_of_memory
      use dem3_handle, only : built_solids, built_solids_take
      integer(c_int64_t), intent(in) :: handle
      !> End time, step (0: the fraction of the critical one) [s], that fraction, tolerance of settling, settlement,
      !> collapse and domain [m], limit of the energy from nowhere
      real(c_double), intent(in) :: numbers(8)
      integer(c_int), intent(in) :: settle_steps              !! 0: no settling
      integer(c_int), intent(in) :: at_rest                   !! 1: stop once all rests and the ground is still
      integer(c_int), intent(in) :: threads                   !! 0: all
      real(c_double), intent(in) :: gravity(3)                !! [m/s^2]
      real(c_double), intent(in) :: way(3)
      integer(c_int), intent(in) :: nb
      real(c_double), intent(in) :: rate(6, nb)               !! [m/s, rad/s]
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      integer :: failed
      call built_solids_take(handle, built, status)
      if (status /= status_ok) return
      status = status_invalid_argument
      if (nb == size(built%set%item) .and. numbers(1) > 0.0_c_double .and. numbers(3) > 0.0_c_double) then
         if (allocated(built%rate)) deallocate (built%rate)
         allocate (built%rate(6, nb), stat=failed)
         status = merge(status_ok, status_out_of_memory, failed == 0)
         if (failed == 0) then
            built%rate(:, :) = rate
            built%gravity = gravity
            built%way = way
            built%options%end_time = numbers(1)
            built%options%step = numbers(2)
            built%options%fraction = numbers(3)
            built%options%settle_tolerance = numbers(4)
            built%options%settlement = numbers(5)
            built%options%collapse = numbers(6)
            built%options%domain = numbers(7)
            built%options%residual_limit = numbers(8)
            built%options%settle_steps = settle_steps
            built%options%stop_at_rest = at_rest /= 0
            built%options%threads = threads
            built%ready = .true.
         end if
      end if
      call handle_leave(handle)
   end subroutine settings

   !> Run from the start under a motion of a set
   subroutine run(handle, motions, motion, scale, nt, wanted, steps, paused, time, status)
      use common_handles, only : handle_leave
      use common_motion_set, only : motion_set, motion_set_take, motion_signal
      use common_signal, only : signal
      use common_status, only : status_ok
      use dem3_handle, only : built_solids, built_solids_take, run_solids
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(in) :: motions               !! handle of a set of motions
      integer(c_int), intent(in) :: motion                    !! its number in the set, 1-based
      real(c_double), intent(in) :: scale                     !! factor on the motion
      integer(c_int), intent(in) :: nt
      real(c_double), intent(in) :: wanted(nt)                !! output times [s]
      integer(c_int), intent(in) :: steps                     !! after which it pauses; 0: it does not
      integer(c_int), intent(out) :: paused                   !! 1: it can go on
      real(c_double), intent(out) :: time                     !! that it has come to [s]
      integer(c_int), intent(out) :: status                   !! cancelled leaves what was recorded
      type(built_solids), pointer :: built
      type(motion_set), pointer :: set
      type(signal) :: ground
      !f2py threadsafe
      paused = 0
      time = 0.0_c_double
      call built_solids_take(handle, built, status)
      if (status /= status_ok) return
      call motion_set_take(motions, .false., set, status)
      if (status == status_ok) then
         call motion_signal(set, motion, scale, ground, status)
         if (status == status_ok) call run_solids(built, ground, wanted, int(steps), status)
         if (allocated(built%record)) then
            paused = merge(1_c_int, 0_c_int, built%record%paused)
            time = built%record%stop_time
         end if
         call handle_leave(motions)
      end if
      call handle_leave(handle)
   end subroutine run

   !> Go on with a run that has paused, under the same motion
   subroutine go_on(handle, motions, motion, scale, steps, paused, time, status)
      use common_handles, only : handle_leave
      use common_motion_set, only : motion_set, motion_set_take, motion_signal
      use common_signal, only : signal
      use common_status, only : status_ok
      use dem3_handle, only : built_solids, built_solids_take, go_on_solids
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(in) :: motions               !! handle of a set of motions
      integer(c_int), intent(in) :: motion                    !! its number in the set, 1-based
      real(c_double), intent(in) :: scale                     !! factor on the motion
      integer(c_int), intent(in) :: steps                     !! after which it pauses; 0: it does not
      integer(c_int), intent(out) :: paused                   !! 1: it can go on
      real(c_double), intent(out) :: time                     !! that it has come to [s]
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      type(motion_set), pointer :: set
      type(signal) :: ground
      !f2py threadsafe
      paused = 0
      time = 0.0_c_double
      call built_solids_take(handle, built, status)
      if (status /= status_ok) return
      call motion_set_take(motions, .false., set, status)
      if (status == status_ok) then
         call motion_signal(set, motion, scale, ground, status)
         if (status == status_ok) call go_on_solids(built, ground, int(steps), status)
         if (allocated(built%record)) then
            paused = merge(1_c_int, 0_c_int, built%record%paused)
            time = built%record%stop_time
         end if
         call handle_leave(motions)
      end if
      call handle_leave(handle)
   end subroutine go_on

   !> Words that the state of a run takes that has paused
   subroutine state_size(handle, words, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_not_ready
      use dem3_handle, only : built_solids, built_solids_take
      use dem3_state, only : state_words
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(out) :: words
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      words = 0
      call built_solids_take(handle, built, status)
      if (status /= status_ok) return
      status = status_not_ready
      if (allocated(built%record)) then
         if (built%record%paused) then
            status = status_ok
            words = state_words(built%model, built%record)
         end if
      end if
      call handle_leave(handle)
   end subroutine state_size

   !> That state, for this build alone
   subroutine state(handle, words, word, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_not_ready
      use dem3_handle, only : built_solids, built_solids_take
      use dem3_state, only : state_save
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: words                     !! see state_size
      integer(c_int64_t), intent(out) :: word(words)
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      word = 0
      call built_solids_take(handle, built, status)
      if (status /= status_ok) return
      status = status_not_ready
      if (allocated(built%record)) then
         if (built%record%paused) call state_save(built%model, built%record, word, status)
      end if
      call handle_leave(handle)
   end subroutine state

   !> Take a state back; then go_on. It must be undamaged: invalid where its head is of another model, run or build
   subroutine resume(handle, nt, wanted, words, word, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem3_handle, only : built_solids, built_solids_take, resume_solids
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nt
      real(c_double), intent(in) :: wanted(nt)                !! output times [s]
      integer(c_int), intent(in) :: words
      integer(c_int64_t), intent(in) :: word(words)
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      call built_solids_take(handle, built, status)
      if (status /= status_ok) return
      call resume_solids(built, wanted, word, status)
      call handle_leave(handle)
   end subroutine resume

   !> What the last run came to
   subroutine summary(handle, counts, measures, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_not_ready
      use dem3_handle, only : built_solids, built_solids_take
      integer(c_int64_t), intent(in) :: handle
      !> Points, reason (list dem_stop), body that caused it, settling steps, searches, most pairs, steps
      integer(c_int), intent(out) :: counts(7)
      real(c_double), intent(out) :: measures(4)              !! least step, critical step, stop time [s], residual
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      counts = 0
      measures = 0.0_c_double
      call built_solids_take(handle, built, status)
      if (status /= status_ok) return
      status = status_not_ready
      if (allocated(built%record)) then
         status = status_ok
         associate (record => built%record)
            counts = [int(record%points, c_int), record%reason, int(record%blamed, c_int), &
               int(record%settling, c_int), int(record%searches, c_int), &
               int(max(record%most_pairs, built%model%pairs), c_int), &
               int(built%model%steps, c_int)]
            measures = [record%least_step, record%critical, record%stop_time, record%residual]
         end associate
      end if
      call handle_leave(handle)
   end subroutine summary

   !> Where the bodies had settled in the last run, and how they left what they touched
   subroutine bodies(handle, nb, place, turn, bounces, airborne, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument, status_not_ready
      use dem3_handle, only : built_solids, built_solids_take
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nb                        !! bodies
      real(c_double), intent(out) :: place(3, nb)             !! settled centroids [m]
      real(c_double), intent(out) :: turn(3, 3, nb)           !! settled axes in the columns
      integer(c_int), intent(out) :: bounces(nb)              !! times that each left all that it touched
      real(c_double), intent(out) :: airborne(nb)             !! time without contact [s]
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      integer :: k
      place = 0.0_c_double
      turn = 0.0_c_double
      bounces = 0
      airborne = 0.0_c_double
      call built_solids_take(handle, built, status)
      if (status /= status_ok) return
      status = status_not_ready
      if (allocated(built%model)) then
         status = merge(status_ok, status_invalid_argument, nb == size(built%set%item))
         if (status == status_ok) then
            do k = 1, nb
               associate (b => built%model%set%item(k))
                  place(:, k) = b%rest
                  turn(:, :, k) = b%rest_turn
                  bounces(k) = int(b%bounces, c_int)
                  airborne(k) = b%airborne
               end associate
            end do
         end if
      end if
      call handle_leave(handle)
   end subroutine bodies

   !> What the last run recorded
   subroutine history(handle, nb, nt, time, place, turn, rate, energy, status)
      use common_handles, only : handle_leave
      use common_lists, only : dem_energy_count
      use common_status, only : status_ok, status_invalid_argument, status_not_ready
      use dem3_handle, only : built_solids, built_solids_take
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nb                        !! bodies
      integer(c_int), intent(in) :: nt                        !! points, see summary
      real(c_double), intent(out) :: time(nt)                 !! [s]
      real(c_double), intent(out) :: place(3, nb, nt)         !! centroids [m]
      real(c_double), intent(out) :: turn(3, 3, nb, nt)       !! columns: principal axes
      real(c_double), intent(out) :: rate(6, nb, nt)          !! [m/s, rad/s]
      real(c_double), intent(out) :: energy(9, nt)            !! [J], rows of the list dem_energy
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      time = 0.0_c_double
      place = 0.0_c_double
      turn = 0.0_c_double
      rate = 0.0_c_double
      energy = 0.0_c_double
      call built_solids_take(handle, built, status)
      if (status /= status_ok) return
      status = status_not_ready
      if (allocated(built%record)) then
         status = status_invalid_argument
         if (nb == size(built%set%item) .and. nt <= built%record%points .and. dem_energy_count == size(energy, 1)) then
            status = status_ok
            time = built%record%time(1:nt)
            place = built%record%place(:, :, 1:nt)
            turn = built%record%turn(:, :, :, 1:nt)
            rate = built%record%rate(:, :, 1:nt)
            energy = built%record%energy(:, 1:nt)
         end if
      end if
      call handle_leave(handle)
   end subroutine history

end module api_dem3
