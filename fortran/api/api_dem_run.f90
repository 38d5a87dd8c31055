!> Runs of discrete elements, of the plane (built by api_dem) or of space (api_dem3).
!>
!> laws, options, rigid, ties and places; then start and run, as often as wanted; then summary, effort, history and tensions of
!> the last run.
!> A run that pauses continues where run is called again; its state can be kept, and given to resume instead of start.
module api_dem_run
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: laws, options, rigid, ties, places, start, run, state_size, state, resume, summary, effort, history, joint_forces, &
      place_forces, tensions

contains

   !> Types of joints; the first is that of contacts that form later
   subroutine laws(handle, nlaw, normal_stiffness, shear_stiffness, friction, cohesion, tension, damping, strength, &
                   status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_out_of_memory
      use dem_handle, only : built_model, model_take, set_laws
      use dem_joint, only : joint_law
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nlaw
      real(c_double), intent(in) :: normal_stiffness(nlaw)    !! units as in joint_law
      real(c_double), intent(in) :: shear_stiffness(nlaw)
      real(c_double), intent(in) :: friction(nlaw)
      real(c_double), intent(in) :: cohesion(nlaw)
      real(c_double), intent(in) :: tension(nlaw)
      real(c_double), intent(in) :: damping(nlaw)
      real(c_double), intent(in) :: strength(nlaw)            !! in compression; 0: corners do not crush
      integer(c_int), intent(out) :: status
      class(built_model), pointer :: built
      type(joint_law), allocatable :: given(:)
      integer :: failed
      call model_take(handle, built, status)
      if (status /= status_ok) return
      allocate (given(nlaw), stat=failed)
      status = status_out_of_memory
      if (failed == 0) then
         given%normal_stiffness = normal_stiffness
         given%shear_stiffness = shear_stiffness
         given%friction = friction
         given%cohesion = cohesion
         given%tension = tension
         given%damping = damping
         given%strength = strength
         call set_laws(built, given, status)
      end if
      call handle_leave(handle)
   end subroutine laws

   !> How to run
   subroutine options(handle, end_time, step, fraction, settle_tolerance, settlement, collapse, residual_limit, &
                      settle_damping, collapse_turn, collapse_drop, calm, settle_steps, stop_at_rest, threads, &
                      status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem_handle, only : built_model, model_take, set_options
      use dem_simulation, only : run_options
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: end_time                  !! [s]; of all of them see run_options
      real(c_double), intent(in) :: step                      !! [s], or 0
      real(c_double), intent(in) :: fraction                  !! of the critical step
      real(c_double), intent(in) :: settle_tolerance
      real(c_double), intent(in) :: settlement                !! farthest [m], or 0
      real(c_double), intent(in) :: collapse                  !! [m], or 0
      real(c_double), intent(in) :: residual_limit
      real(c_double), intent(in) :: settle_damping            !! [s]
      real(c_double), intent(in) :: collapse_turn             !! [rad]
      real(c_double), intent(in) :: collapse_drop             !! [m]
      real(c_double), intent(in) :: calm(2)                   !! safe, or 0, and above [J]
      integer(c_int), intent(in) :: settle_steps              !! at most; 0: no settling
      integer(c_int), intent(in) :: stop_at_rest              !! 1: end once all is quiet
      integer(c_int), intent(in) :: threads
      integer(c_int), intent(out) :: status
      class(built_model), pointer :: built
      call model_take(handle, built, status)
      if (status /= status_ok) return
      call set_options(built, run_options(end_time=end_time, step=step, fraction=fraction, &
         settle_tolerance=settle_tolerance, settlement=settlement, collapse=collapse, residual_limit=residual_limit, &
         settle_damping=settle_damping, collapse_turn=collapse_turn, collapse_drop=collapse_drop, &
         safe=calm(1), above=calm(2), settle_steps=int(settle_steps), stop_at_rest=stop_at_rest /= 0, threads=int(threads)), status)
      call handle_leave(handle)
   end subroutine options

   !> Contacts without springs instead of the joints' stiffness and damping
   subroutine rigid(handle, used, quasi_static, rebound, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem_handle, only : built_model, model_take
      use dem_rigid, only : rigid_setting
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: used                      !! 1: rigid contacts
      integer(c_int), intent(in) :: quasi_static              !! 1: every step starts from rest
      real(c_double), intent(in) :: rebound                   !! coefficient of restitution at a contact point, 0 to 1
      integer(c_int), intent(out) :: status
      class(built_model), pointer :: built
      call model_take(handle, built, status)
      if (status /= status_ok) return
      if (.not. (rebound >= 0.0_c_double .and. rebound <= 1.0_c_double)) then
         status = status_invalid_argument
      else
         built%rigid = rigid_setting(used /= 0, quasi_static /= 0, rebound)
      end if
      call handle_leave(handle)
   end subroutine rigid

   !> Ties, chains and hoops, see dem_ties
   subroutine ties(handle, ntie, nanchor, nbody, value, first, closed, body, point, place, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem_handle, only : built_model, model_take
      use dem_ties, only : tie_set_new
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: ntie
      integer(c_int), intent(in) :: nanchor
      integer(c_int), intent(in) :: nbody                     !! of the model
      real(c_double), intent(in) :: value(7, ntie)            !! stiffness, length, prestress, least, most, damping, power
      integer(c_int), intent(in) :: first(ntie + 1)           !! first point of each, 1-based
      integer(c_int), intent(in) :: closed(ntie)              !! 1: a hoop
      integer(c_int), intent(in) :: body(nanchor)             !! 1-based; 0: the ground
      integer(c_int), intent(in) :: point(nanchor)            !! of the line, 1-based
      real(c_double), intent(in) :: place(3, nanchor)         !! in the frame of the body [m]
      integer(c_int), intent(out) :: status
      class(built_model), pointer :: built
      call model_take(handle, built, status)
      if (status /= status_ok) return
      call tie_set_new(value, first, closed, body, point, place, int(nbody), built%ties, status)
      call handle_leave(handle)
   end subroutine ties

   !> Contacts whose forces are recorded with their places, see dem_places
   subroutine places(handle, ncontact, ncorner, joint, corner, x, normal, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem_handle, only : built_model, model_take
      use dem_places, only : places_new
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: ncontact
      integer(c_int), intent(in) :: ncorner
      integer(c_int), intent(in) :: joint(ncontact)           !! its pair, in the order of joint_forces, 1-based; ascending
      integer(c_int), intent(in) :: corner(ncontact + 1)      !! first corner of each, 1-based
      real(c_double), intent(in) :: x(3, ncorner)             !! in the frame of the first body [m]
      real(c_double), intent(in) :: normal(3, ncontact)       !! unit vectors in that frame
      integer(c_int), intent(out) :: status
      class(built_model), pointer :: built
      call model_take(handle, built, status)
      if (status /= status_ok) return
      call places_new(joint, corner, x, normal, built%places, status)
      call handle_leave(handle)
   end subroutine places

   !> A run that has not begun, instead of the last one
   subroutine start(handle, nt, wanted, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem_handle, only : built_model, model_take, new_run
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nt
      real(c_double), intent(in) :: wanted(nt)                !! output times [s]
      integer(c_int), intent(out) :: status
      class(built_model), pointer :: built
      call model_take(handle, built, status)
      if (status /= status_ok) return
      call new_run(built, wanted, status)
      call handle_leave(handle)
   end subroutine start

   !> Settle, shake, record: begin, or go on where it has paused, under the same motion
   subroutine run(handle, motions, motion, across, scale, steps, paused, time, status)
      use common_handles, only : handle_leave
      use common_motion_set, only : motion_set, motion_set_take, motion_signal
      use common_signal, only : signal
      use common_status, only : status_ok
      use dem_handle, only : built_model, model_take, run_built
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(in) :: motions               !! handle of a set of motions
      integer(c_int), intent(in) :: motion                    !! its number in the set, 1-based
      integer(c_int), intent(in) :: across                    !! that of the other horizontal one, in space; 0: none
      real(c_double), intent(in) :: scale                     !! factor on both
      integer(c_int), intent(in) :: steps                     !! after which it pauses; 0: it does not
      integer(c_int), intent(out) :: paused                   !! 1: it can go on
      real(c_double), intent(out) :: time                     !! that it has come to [s]
      integer(c_int), intent(out) :: status                   !! cancelled leaves what was recorded
      class(built_model), pointer :: built
      type(motion_set), pointer :: set
      type(signal) :: ground, other
      logical :: waits
      !f2py threadsafe
      paused = 0
      time = 0.0_c_double
      call model_take(handle, built, status)
      if (status /= status_ok) return
      call motion_set_take(motions, .false., set, status)
      if (status == status_ok) then
         call motion_signal(set, motion, scale, ground, status)
         if (status == status_ok .and. across /= 0) call motion_signal(set, across, scale, other, status)
         if (status == status_ok) then
            call run_built(built, ground, other, int(steps), waits, time, status)
            paused = merge(1_c_int, 0_c_int, waits)
         end if
         call handle_leave(motions)
      end if
      call handle_leave(handle)
   end subroutine run

   !> Words that the state of a run takes that has paused
   subroutine state_size(handle, words, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem_handle, only : paused_run_take
      use dem_simulation, only : simulation
      use dem_state, only : state_words
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(out) :: words
      integer(c_int), intent(out) :: status
      class(simulation), pointer :: run
      words = 0
      call paused_run_take(handle, run, status)
      if (status /= status_ok) return
      words = state_words(run)
      call handle_leave(handle)
   end subroutine state_size

   !> That state, for this build alone
   subroutine state(handle, words, word, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem_handle, only : paused_run_take
      use dem_simulation, only : simulation
      use dem_state, only : state_save
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: words                     !! see state_size
      integer(c_int64_t), intent(out) :: word(words)
      integer(c_int), intent(out) :: status
      class(simulation), pointer :: run
      word = 0
      call paused_run_take(handle, run, status)
      if (status /= status_ok) return
      call state_save(run, word, status)
      call handle_leave(handle)
   end subroutine state

   !> Instead of a start: take a state back. It must be undamaged: invalid where its head is of another model or build
   subroutine resume(handle, nt, wanted, words, word, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem_handle, only : built_model, model_take, resume_run
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nt
      real(c_double), intent(in) :: wanted(nt)                !! output times [s]
      integer(c_int), intent(in) :: words
      integer(c_int64_t), intent(in) :: word(words)
      integer(c_int), intent(out) :: status
      class(built_model), pointer :: built
      call model_take(handle, built, status)
      if (status /= status_ok) return
      call resume_run(built, wanted, word, status)
      call handle_leave(handle)
   end subroutine resume

   !> How the last run ended
   subroutine summary(handle, counts, measures, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem_handle, only : run_take
      use dem_jointed, only : jointed_model
      use dem_simulation, only : simulation
      integer(c_int64_t), intent(in) :: handle
      !> Points, reason (list dem_stop), two bodies that caused it, settling steps, searches, most pairs, steps
      integer(c_int), intent(out) :: counts(8)
      real(c_double), intent(out) :: measures(4)              !! least step, critical step, stop time [s], residual
      integer(c_int), intent(out) :: status
      class(simulation), pointer :: run
      class(jointed_model), pointer :: model
      counts = 0
      measures = 0.0_c_double
      call run_take(handle, run, status)
      if (status /= status_ok) return
      model => run%get_model()
      associate (record => run%record)
         counts = [int(record%points, c_int), record%reason, int(record%blamed, c_int), int(record%settling, c_int), &
            int(record%searches, c_int), int(max(record%most_pairs, record%pairs), c_int), int(model%steps, c_int)]
         measures = [record%least_step, record%critical, record%stop_time, record%residual]
      end associate
      call handle_leave(handle)
   end subroutine summary

   !> What rigid contacts took in the last run
   subroutine effort(handle, counts, measures, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem_handle, only : run_take
      use dem_jointed, only : jointed_model
      use dem_simulation, only : simulation
      integer(c_int64_t), intent(in) :: handle
      !> Steps, factorisations, most rounds of a step, steps that did not converge
      integer(c_int), intent(out) :: counts(4)
      !> Greatest violation over gravity's velocity in a step, and when that was [s]
      real(c_double), intent(out) :: measures(2)
      integer(c_int), intent(out) :: status
      class(simulation), pointer :: run
      class(jointed_model), pointer :: model
      counts = 0
      measures = 0.0_c_double
      call run_take(handle, run, status)
      if (status /= status_ok) return
      model => run%get_model()
      associate (solver => model%rigid)
         counts = int([solver%steps, solver%factors, solver%most_rounds, solver%open_steps], c_int)
         measures = [solver%residual, solver%worst]
      end associate
      call handle_leave(handle)
   end subroutine effort

   !> What the last run recorded
   subroutine history(handle, nb, nrate, nt, time, place, rate, energy, status)
      use common_handles, only : handle_leave
      use common_lists, only : dem_energy_count
      use common_status, only : status_ok, status_invalid_argument
      use dem_handle, only : run_take
      use dem_simulation, only : simulation
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nb                        !! bodies
      integer(c_int), intent(in) :: nrate                     !! rates of a body: 3 in the plane, 6 in space
      integer(c_int), intent(in) :: nt                        !! points, see summary
      real(c_double), intent(out) :: time(nt)                 !! [s]
      real(c_double), intent(out) :: place(3, nb, nt)         !! plane: x, y [m], rotation [rad]; space: centroids [m]
      real(c_double), intent(out) :: rate(nrate, nb, nt)      !! velocity, spin [m/s, rad/s]
      real(c_double), intent(out) :: energy(9, nt)            !! [J], rows of the list dem_energy
      integer(c_int), intent(out) :: status
      class(simulation), pointer :: run
      time = 0.0_c_double
      place = 0.0_c_double
      rate = 0.0_c_double
      energy = 0.0_c_double
      call run_take(handle, run, status)
      if (status /= status_ok) return
      associate (record => run%record)
         status = status_invalid_argument
         if (nb == size(record%place, 2) .and. nrate == size(record%rate, 1) .and. nt <= record%points &
             .and. dem_energy_count == size(energy, 1)) then
            status = status_ok
            time = record%time(1:nt)
            place = record%place(:, :, 1:nt)
            rate = record%rate(:, :, 1:nt)
            energy = record%energy(:, 1:nt)
         end if
      end associate
      call handle_leave(handle)
   end subroutine history

   !> Forces and losses of the joints at the points of the last run's history
   subroutine joint_forces(handle, nj, nt, joint, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem_handle, only : run_take
      use dem_simulation, only : simulation
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nj                        !! joints, in the order of their lower bodies
      integer(c_int), intent(in) :: nt                        !! points, see summary
      !> force on the first body, in the plane x, y, 0 [N]; losses by friction and in dashpots [J]
      real(c_double), intent(out) :: joint(5, nj, nt)
      integer(c_int), intent(out) :: status
      class(simulation), pointer :: run
      joint = 0.0_c_double
      call run_take(handle, run, status)
      if (status /= status_ok) return
      status = status_invalid_argument
      if (nj == size(run%record%joint, 2) .and. nt <= run%record%points) then
         status = status_ok
         joint = run%record%joint(:, :, 1:nt)
      end if
      call handle_leave(handle)
   end subroutine joint_forces

   !> Forces of the contacts of `places` at the points of the last run's history
   subroutine place_forces(handle, nc, nt, press, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem_handle, only : run_take
      use dem_simulation, only : simulation
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nc                        !! contacts
      integer(c_int), intent(in) :: nt                        !! points, see summary
      !> force on the first body [N], normal force [N], normal force times its place in the frame of that body [N m]
      real(c_double), intent(out) :: press(7, nc, nt)
      integer(c_int), intent(out) :: status
      class(simulation), pointer :: run
      press = 0.0_c_double
      call run_take(handle, run, status)
      if (status /= status_ok) return
      status = status_invalid_argument
      if (nc == size(run%record%press, 2) .and. nt <= run%record%points) then
         status = status_ok
         press = run%record%press(:, :, 1:nt)
      end if
      call handle_leave(handle)
   end subroutine place_forces

   !> Tensions in the ties that the last run recorded, and of all its steps the extremes
   subroutine tensions(handle, ntie, nt, tension, extreme, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem_handle, only : run_take
      use dem_jointed, only : jointed_model
      use dem_simulation, only : simulation
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: ntie
      integer(c_int), intent(in) :: nt                        !! points, see summary
      real(c_double), intent(out) :: tension(ntie, nt)        !! [N]
      real(c_double), intent(out) :: extreme(3, ntie)         !! least, greatest [N], plastic elongation at the end [m]
      integer(c_int), intent(out) :: status
      class(simulation), pointer :: run
      class(jointed_model), pointer :: model
      tension = 0.0_c_double
      extreme = 0.0_c_double
      call run_take(handle, run, status)
      if (status /= status_ok) return
      associate (record => run%record)
         status = status_invalid_argument
         if (ntie == size(record%tension, 1) .and. nt <= record%points) then
            status = status_ok
            tension = record%tension(:, 1:nt)
            model => run%get_model()
            extreme(1, :) = model%ties%item%lowest
            extreme(2, :) = model%ties%item%highest
            extreme(3, :) = model%ties%item%plastic
         end if
      end associate
      call handle_leave(handle)
   end subroutine tensions

end module api_dem_run
