!> Discrete elements: a model behind a handle, built in steps, run, and read.
!>
!> create, laws, joints, start, moves, settings; then run as often as wanted; then summary, history, bodies and
!> contacts tell the last run. A run that pauses goes on with go_on; its state can be kept, and taken back by resume.
!> Body numbers are 1-based; mass 0 marks a support.
module api_dem
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: create, laws, joints, start, moves, settings, rigid, run, go_on, state_size, state, resume
   public :: summary, effort, history, bodies, contacts

contains

   !> Bodies made of convex parts
   subroutine create(nb, npart, nvert, centroid, mass, inertia, owner, first, vertex, outer, handle, status)
      use common_status, only : status_ok, status_out_of_memory
      use dem_bodies, only : body_set_new
      use dem_handle, only : built_model, built_model_register
      integer(c_int), intent(in) :: nb                        !! bodies
      integer(c_int), intent(in) :: npart                     !! convex parts
      integer(c_int), intent(in) :: nvert                     !! vertices of all parts
      real(c_double), intent(in) :: centroid(2, nb)           !! [m]
      real(c_double), intent(in) :: mass(nb)                  !! [kg]
      real(c_double), intent(in) :: inertia(nb)               !! [kg m^2]
      integer(c_int), intent(in) :: owner(npart)              !! body of each part
      integer(c_int), intent(in) :: first(npart + 1)          !! first vertex of each part
      real(c_double), intent(in) :: vertex(2, nvert)          !! [m]
      integer(c_int), intent(in) :: outer(nvert)              !! 1: the edge that starts here is on the outline
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      integer :: failed
      handle = 0
      status = status_out_of_memory
      allocate (built, stat=failed)
      if (failed /= 0) return
      call body_set_new(centroid, mass, inertia, owner, first, vertex, outer, built%set, status)
      if (status == status_ok) then
         call built_model_register(built, handle, status)
      else
         deallocate (built)
      end if
   end subroutine create

   !> Types of joints; the first is that of contacts that form later
   subroutine laws(handle, nlaw, law, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_out_of_memory
      use dem_handle, only : built_model, built_model_take, set_laws
      use dem_law, only : joint_law
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nlaw
      real(c_double), intent(in) :: law(6, nlaw)              !! see joint_law
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      type(joint_law), allocatable :: given(:)
      integer :: k, failed
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      allocate (given(nlaw), stat=failed)
      status = status_out_of_memory
      if (failed == 0) then
         do k = 1, nlaw
            given(k) = joint_law(law(1, k), law(2, k), law(3, k), law(4, k), law(5, k), law(6, k))
         end do
         call set_laws(built, given, status)
      end if
      call handle_leave(handle)
   end subroutine laws

   !> Joints with a type of their own
   subroutine joints(handle, njoint, pair, law, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem_handle, only : built_model, built_model_take, set_joints
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: njoint
      integer(c_int), intent(in) :: pair(2, njoint)           !! bodies
      integer(c_int), intent(in) :: law(njoint)               !! type, 1-based
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      call set_joints(built, pair, law, status)
      call handle_leave(handle)
   end subroutine joints

   !> Initial displacement and velocity about the centroids
   subroutine start(handle, nb, shift, rate, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem_handle, only : built_model, built_model_take, set_start
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nb                        !! bodies
      real(c_double), intent(in) :: shift(3, nb)              !! x, y [m], rotation [rad]
      real(c_double), intent(in) :: rate(3, nb)               !! [m/s, rad/s]
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      if (nb /= size(built%set%item)) status = status_invalid_argument
      if (status == status_ok) call set_start(built, shift, rate)
      call handle_leave(handle)
   end subroutine start

   !> Supports that give way
   subroutine moves(handle, nmove, body, move, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_out_of_memory
      use dem_handle, only : built_model, built_model_take, set_moves
      use dem_loading, only : support_move
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nmove
      integer(c_int), intent(in) :: body(nmove)               !! support that moves
      real(c_double), intent(in) :: move(5, nmove)            !! dx, dy [m], turn [rad], start, duration [s]
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      type(support_move), allocatable :: given(:)
      integer :: k, failed
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      allocate (given(nmove), stat=failed)
      status = status_out_of_memory
      if (failed == 0) then
         do k = 1, nmove
            given(k) = support_move(int(body(k)), move(1:3, k), move(4, k), move(5, k))
         end do
         call set_moves(built, given, status)
      end if
      call handle_leave(handle)
   end subroutine moves

   !> How to run
   subroutine settings(handle, gravity, mass_damping, moving_base, limits, domain, settle_steps, stop_at_rest, &
                       threads, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem_handle, only : built_model, built_model_take
      use dem_run, only : run_options
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: gravity(2)                !! [m/s^2]
      real(c_double), intent(in) :: mass_damping              !! alpha [1/s]
      integer(c_int), intent(in) :: moving_base               !! 1: the supports move, 0: body force
      !> End time [s], step [s] or 0, fraction of the critical step, settling tolerance, collapse [m] or 0,
      !> limit of the energy residual, farthest settlement [m] or 0
      real(c_double), intent(in) :: limits(7)
      real(c_double), intent(in) :: domain(4)                 !! left, right, bottom, top [m]
      integer(c_int), intent(in) :: settle_steps              !! at most; 0: no settling
      integer(c_int), intent(in) :: stop_at_rest              !! 1: end once all is quiet
      integer(c_int), intent(in) :: threads
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      if (.not. (limits(1) > 0.0_c_double .and. limits(3) > 0.0_c_double .and. limits(3) <= 1.0_c_double &
                 .and. all(limits >= 0.0_c_double) .and. mass_damping >= 0.0_c_double .and. threads >= 1)) then
         status = status_invalid_argument
      else
         built%load%gravity = gravity
         built%load%moving_base = moving_base /= 0
         built%mass_damping = mass_damping
         built%options = run_options(limits(1), limits(2), limits(3), limits(4), int(settle_steps), limits(5), domain, &
            limits(6), stop_at_rest /= 0, int(threads), limits(7))
         built%settled = .true.
      end if
      call handle_leave(handle)
   end subroutine settings

   !> Contacts without springs instead of the joints' stiffness and damping
   subroutine rigid(handle, used, quasi_static, rebound, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem_handle, only : built_model, built_model_take
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: used                      !! 1: rigid contacts
      integer(c_int), intent(in) :: quasi_static              !! 1: every step starts from rest
      real(c_double), intent(in) :: rebound                   !! coefficient of restitution at a contact point, 0 to 1
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      if (.not. (rebound >= 0.0_c_double .and. rebound <= 1.0_c_double)) then
         status = status_invalid_argument
      else
         built%rigid = used /= 0
         built%quasi_static = used /= 0 .and. quasi_static /= 0
         built%rebound = rebound
      end if
      call handle_leave(handle)
   end subroutine rigid

   !> Settle, shake, record; pauses after some steps where asked
   subroutine run(handle, motions, motion, scale, nt, wanted, steps, paused, time, status)
      use common_handles, only : handle_leave
      use common_motion_set, only : motion_set, motion_set_take, motion_signal
      use common_signal, only : signal
      use common_status, only : status_ok
      use dem_handle, only : built_model, built_model_take, run_built
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
      type(built_model), pointer :: built
      type(motion_set), pointer :: set
      type(signal) :: ground
      !f2py threadsafe
      paused = 0
      time = 0.0_c_double
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      call motion_set_take(motions, .false., set, status)
      if (status == status_ok) then
         call motion_signal(set, motion, scale, ground, status)
         if (status == status_ok) call run_built(built, ground, wanted, int(steps), status)
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
      use dem_handle, only : built_model, built_model_take, go_on_built
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(in) :: motions               !! handle of a set of motions
      integer(c_int), intent(in) :: motion                    !! its number in the set, 1-based
      real(c_double), intent(in) :: scale                     !! factor on the motion
      integer(c_int), intent(in) :: steps                     !! after which it pauses; 0: it does not
      integer(c_int), intent(out) :: paused                   !! 1: it can go on
      real(c_double), intent(out) :: time                     !! that it has come to [s]
      integer(c_int), intent(out) :: status                   !! cancelled leaves what was recorded
      type(built_model), pointer :: built
      type(motion_set), pointer :: set
      type(signal) :: ground
      !f2py threadsafe
      paused = 0
      time = 0.0_c_double
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      call motion_set_take(motions, .false., set, status)
      if (status == status_ok) then
         call motion_signal(set, motion, scale, ground, status)
         if (status == status_ok) call go_on_built(built, ground, int(steps), status)
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
      use dem_handle, only : built_model, built_model_take
      use dem_state, only : state_words
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(out) :: words
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      words = 0
      call built_model_take(handle, built, status)
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
      use dem_handle, only : built_model, built_model_take
      use dem_state, only : state_save
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: words                     !! see state_size
      integer(c_int64_t), intent(out) :: word(words)
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      word = 0
      call built_model_take(handle, built, status)
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
      use dem_handle, only : built_model, built_model_take, resume_built
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nt
      real(c_double), intent(in) :: wanted(nt)                !! output times [s]
      integer(c_int), intent(in) :: words
      integer(c_int64_t), intent(in) :: word(words)
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      call resume_built(built, wanted, word, status)
      call handle_leave(handle)
   end subroutine resume

   !> How the last run ended
   subroutine summary(handle, counts, measures, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_not_ready
      use dem_handle, only : built_model, built_model_take, closed_contacts
      integer(c_int64_t), intent(in) :: handle
      !> Points, reason (list dem_stop), two bodies that caused it, settling steps, searches, most pairs, steps,
      !> closed contact points
      integer(c_int), intent(out) :: counts(9)
      real(c_double), intent(out) :: measures(4)              !! least step, critical step, stop time [s], residual
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      integer(c_int) :: nobody(2, 0)
      real(c_double) :: nothing(6, 0)
      integer :: closed
      counts = 0
      measures = 0.0_c_double
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      status = status_not_ready
      if (allocated(built%record)) then
         status = status_ok
         associate (model => built%model, record => built%record)
            call closed_contacts(model, nobody, nothing, closed)
            counts = [int(record%points, c_int), record%reason, int(record%blamed, c_int), &
               int(record%settling, c_int), int(record%searches, c_int), &
               int(max(record%most_pairs, model%contacts%pairs), c_int), int(model%steps, c_int), int(closed, c_int)]
            measures = [record%least_step, record%critical, record%stop_time, record%residual]
         end associate
      end if
      call handle_leave(handle)
   end subroutine summary

   !> What rigid contacts took in the last run
   subroutine effort(handle, counts, residual, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_not_ready
      use dem_handle, only : built_model, built_model_take
      integer(c_int64_t), intent(in) :: handle
      !> Steps, factorisations, most rounds of a step, steps that did not converge
      integer(c_int), intent(out) :: counts(4)
      real(c_double), intent(out) :: residual                 !! greatest violation over gravity's velocity in a step
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      counts = 0
      residual = 0.0_c_double
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      status = status_not_ready
      if (allocated(built%record)) then
         status = status_ok
         associate (used => built%model%rigid)
            counts = int([used%steps, used%factors, used%most_rounds, used%open_steps], c_int)
            residual = used%residual
         end associate
      end if
      call handle_leave(handle)
   end subroutine effort

   !> What the last run recorded
   subroutine history(handle, nb, nt, time, place, rate, energy, status)
      use common_handles, only : handle_leave
      use common_lists, only : dem_energy_count
      use common_status, only : status_ok, status_invalid_argument, status_not_ready
      use dem_handle, only : built_model, built_model_take
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nb                        !! bodies
      integer(c_int), intent(in) :: nt                        !! points, see summary
      real(c_double), intent(out) :: time(nt)                 !! [s]
      real(c_double), intent(out) :: place(3, nb, nt)         !! x, y [m], rotation [rad]
      real(c_double), intent(out) :: rate(3, nb, nt)          !! [m/s, rad/s]
      real(c_double), intent(out) :: energy(9, nt)            !! [J], rows of the list dem_energy
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      time = 0.0_c_double
      place = 0.0_c_double
      rate = 0.0_c_double
      energy = 0.0_c_double
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      status = status_not_ready
      if (allocated(built%record)) then
         status = status_invalid_argument
         if (nb == size(built%set%item) .and. nt <= built%record%points .and. dem_energy_count == size(energy, 1)) then
            status = status_ok
            time = built%record%time(1:nt)
            place = built%record%place(:, :, 1:nt)
            rate = built%record%rate(:, :, 1:nt)
            energy = built%record%energy(:, 1:nt)
         end if
      end if
      call handle_leave(handle)
   end subroutine history

   !> The bodies at the end of the last run
   subroutine bodies(handle, nb, settled, bounces, airborne, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument, status_not_ready
      use dem_handle, only : built_model, built_model_take
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nb                        !! bodies
      real(c_double), intent(out) :: settled(3, nb)           !! place after settling: x, y [m], rotation [rad]
      integer(c_int), intent(out) :: bounces(nb)              !! times contact was lost
      real(c_double), intent(out) :: airborne(nb)             !! [s]
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      settled = 0.0_c_double
      bounces = 0
      airborne = 0.0_c_double
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      status = status_not_ready
      if (allocated(built%record)) then
         status = status_invalid_argument
         if (nb == size(built%model%set%item)) then
            status = status_ok
            associate (item => built%model%set%item)
               settled(1, :) = item%rest_x
               settled(2, :) = item%rest_y
               settled(3, :) = item%rest_angle
               bounces = int(item%bounces, c_int)
               airborne = item%airborne
            end associate
         end if
      end if
      call handle_leave(handle)
   end subroutine bodies

   !> Contact points closed at the end of the last run
   subroutine contacts(handle, room, body, value, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_not_ready
      use dem_handle, only : built_model, built_model_take, closed_contacts
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: room                      !! closed contact points, see summary
      integer(c_int), intent(out) :: body(2, room)
      !> x, y [m], force on the second body x, y [N], normal, shear [N]
      real(c_double), intent(out) :: value(6, room)
      integer(c_int), intent(out) :: status
      type(built_model), pointer :: built
      integer :: closed
      body = 0
      value = 0.0_c_double
      call built_model_take(handle, built, status)
      if (status /= status_ok) return
      status = status_not_ready
      if (allocated(built%record)) then
         status = status_ok
         call closed_contacts(built%model, body, value, closed)
      end if
      call handle_leave(handle)
   end subroutine contacts

end module api_dem
