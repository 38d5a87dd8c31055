!> Pushover of a frame of macro-elements, in displacement control, and its motion under a ground acceleration.
module frame_push
   use common_c_bindings, only : extrados_cancel_get
   use common_kinds, only : wp
   use common_lists, only : frame_state_failed_flexure, frame_stop_target, frame_stop_drop, frame_stop_weight, &
      frame_stop_step, frame_stop_steps, frame_stop_cancelled
   use common_status, only : status_ok, status_out_of_memory, status_too_many_steps
   use frame_model, only : frame, frame_state, frame_state_new, take_over, assemble, equilibrate, commit, solve
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: push_path, push_path_new, push_frame, weigh_frame, move_frame

   !> States in equilibrium along a run
   type :: push_path
      integer :: count = 0
      integer :: loose = 0                            !! freedom that moved most when no equilibrium was found; 0: none
      real(wp), allocatable :: curve(:, :)            !! (2, most) control displacement [m], multiple of the pattern
      real(wp), allocatable :: displacement(:, :)     !! (n, most)
      real(wp), allocatable :: force(:, :, :)         !! (3, elements, most) N, moments at both ends
      real(wp), allocatable :: drift(:, :)            !! (elements, most) greatest chord rotation
      integer(c_int), allocatable :: state(:, :)      !! (elements, most) of the list frame_state
   end type push_path

   !> The last step of a run. The next one begins as if it went on, so that the piers which slide do so from the first
   !> iteration on: an elastic beginning overshoots, more piers seem to slide, and the iterations diverge.
   type :: last_step
      real(wp) :: length = 0.0_wp                     !! 0: none
      real(wp) :: multiple = 0.0_wp
      real(wp), allocatable :: d(:)                   !! (n)
      real(wp), allocatable :: slip(:)                !! (elements)
   end type last_step

   !> Step over the greatest in which shear strengths follow the forces of the last equilibrium. It is taken where no
   !> smaller step converges: friction makes the problem unsymmetric, and it may have no solution nearby.
   real(wp), parameter :: lagged_step = 0.1_wp
   !> The step, over the greatest, within which the displacement at a drift limit is found
   real(wp), parameter :: event_step = 0.02_wp
   !> The least step, over the greatest; parts in which moments of failed elements fade, at most
   real(wp), parameter :: least_step = 1.0e-4_wp
   integer, parameter :: most_parts = 256

contains

   !> Room for the states of a run
   pure subroutine push_path_new(n, elements, most, path, status)
      integer(c_int), intent(in) :: n            !! freedoms
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: most         !! states
      type(push_path), intent(out) :: path
      integer(c_int), intent(out) :: status
      integer :: failed
      allocate (path%curve(2, most), path%displacement(n, most), path%force(3, elements, most), &
         path%drift(elements, most), path%state(elements, most), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      path%curve = 0.0_wp
      path%displacement = 0.0_wp
      path%force = 0.0_wp
      path%drift = 0.0_wp
      path%state = 0
   end subroutine push_path_new

   !> Equilibrium under the weight, brought on in parts where it is not found at once.
   !>
   !> Own weights act between the nodes in the end alone: without pressure they would open the upper half of each element.
   subroutine weigh_frame(model, state, status)
      type(frame), intent(in) :: model
      type(frame_state), intent(out) :: state
      integer(c_int), intent(out) :: status
      type(frame_state) :: now
      real(wp) :: nothing(model%n), multiple
      integer :: failed, k, parts
      nothing = 0.0_wp
      multiple = 0.0_wp
      parts = 1
      do
         call frame_state_new(model, state, failed)
         if (failed == 0) call frame_state_new(model, now, failed)
         status = status_out_of_memory
         if (failed /= 0) return
         do k = 1, parts
            call take_over(state, now)
            call equilibrate(model, real(k, wp) / real(parts, wp), state, nothing, nothing, 0.0_wp, .false., now, &
               multiple, status)
            if (status /= status_ok) exit
            call commit(model, now, failed)
            call take_over(now, state)
         end do
         if (status == status_ok .or. parts >= 16) exit
         parts = 4 * parts
      end do
      if (status /= status_ok .or. .not. any(model%element%own_weight > 0.0_wp)) return
      state%element%settled = .true.
      call take_over(state, now)
      call equilibrate(model, 1.0_wp, state, nothing, nothing, 0.0_wp, .false., now, multiple, status)
      if (status /= status_ok) return
      call commit(model, now, failed)
      call take_over(now, state)
   end subroutine weigh_frame

   !> Push a frame by a growing multiple of a pattern until the target, a loss of strength, or no equilibrium is found
   subroutine push_frame(model, pattern, control, target, steps, drop, path, ended, status)
      type(frame), intent(in) :: model
      real(wp), intent(in) :: pattern(:)              !! (n) forces of the multiple 1
      real(wp), intent(in) :: control(:)              !! (n) control displacement is control . d
      real(wp), intent(in) :: target                  !! its last value, beyond that under the weight; positive [m]
      integer, intent(in) :: steps                    !! wanted steps
      real(wp), intent(in) :: drop                    !! ends where the multiple is below this share of its greatest
      type(push_path), intent(inout) :: path          !! with room
      integer(c_int), intent(out) :: ended             !! of the list frame_stop
      integer(c_int), intent(out) :: status
      type(frame_state) :: past, now
      real(wp) :: multiple, trial, start, moved, step, most, greatest
      type(last_step) :: last
      logical :: goes_on, cut
      integer :: failed
      path%count = 0
      path%loose = 0
      goes_on = .false.
      ended = frame_stop_weight
      call weigh_frame(model, past, status)
      if (status /= status_ok) then
         if (status /= status_out_of_memory) status = status_ok
         return
      end if
      call frame_state_new(model, now, failed)
      if (failed /= 0) status = status_out_of_memory
      if (failed /= 0) return
      multiple = 0.0_wp
      greatest = 0.0_wp
      start = dot_product(control, past%d)
      moved = 0.0_wp
      call note(path, past, moved, multiple)
      most = target / real(steps, wp)
      step = 0.05_wp * most
      ended = frame_stop_target
      do while (moved < target * (1.0_wp - 1.0e-12_wp))
         if (extrados_cancel_get() /= 0) then
            ended = frame_stop_cancelled
            return
         end if
         ended = frame_stop_steps
         if (path%count + most_parts > size(path%curve, 2)) return
         step = min(step, target - moved, max(0.05_wp * most, 0.1_wp * moved), most)
         call take_over(past, now)
         trial = multiple
         if (goes_on) call go_on(last, step, now, trial)
         call equilibrate(model, 1.0_wp, past, pattern, control, start + moved + step, .true., now, trial, status)
         if (status /= status_ok) then
            status = status_ok
            call begin_otherwise(last, goes_on, cut)
            if (.not. cut) cycle
            step = 0.5_wp * step
            ended = frame_stop_step
            if (step < least_step * most) then
               if (now%damped .and. now%lagged) then
                  path%loose = maxloc(abs(now%d - past%d), 1)
                  return
               end if
               call try_otherwise(now)
               step = merge(most, lagged_step * most, now%damped)   ! damped, it may jump to another branch
            end if
            cycle
         end if
         call commit(model, now, failed)
         if (failed > 0 .and. step > event_step * most .and. .not. now%damped) then   ! closer to where a limit is reached
            step = 0.25_wp * step
            cycle
         end if
         now%lagged = .false.
         now%damped = .false.
         goes_on = .true.
         call keep_step(last, step, past, now, trial - multiple)
         moved = moved + step
         multiple = trial
         call take_over(now, past)
         call note(path, past, moved, multiple)
         if (failed > 0) then
            goes_on = .false.
            last%length = 0.0_wp
            call redistribute(model, pattern, control, start, moved, past, multiple, path, status)
            if (status /= status_ok) then
               status = status_ok
               ended = frame_stop_step
               return
            end if
         end if
         greatest = max(greatest, multiple)
         ended = frame_stop_drop
         if (multiple < drop * greatest) return
         ended = frame_stop_target
         step = 2.0_wp * step
      end do
   end subroutine push_frame

   !> Begin a step as if the last one went on
   pure subroutine go_on(last, length, now, multiple)
      type(last_step), intent(in) :: last
      real(wp), intent(in) :: length
      type(frame_state), intent(inout) :: now
      real(wp), intent(inout) :: multiple
      real(wp) :: ratio
      ratio = length / last%length
      now%d(:) = now%d + ratio * last%d
      now%element%slip = now%element%slip + ratio * last%slip
      multiple = multiple + ratio * last%multiple
   end subroutine go_on

   !> What is tried where no smaller step converges: strengths by the last equilibrium, then damped iterations, then both
   pure subroutine try_otherwise(now)
      type(frame_state), intent(inout) :: now
      logical :: was
      was = now%damped
      now%damped = was .or. now%lagged
      now%lagged = was .or. .not. now%lagged
   end subroutine try_otherwise

   !> How a step that failed begins anew: first from the last equilibrium; then it is cut, and goes on as the last one did
   pure subroutine begin_otherwise(last, goes_on, cut)
      type(last_step), intent(in) :: last
      logical, intent(inout) :: goes_on
      logical, intent(out) :: cut
      cut = .not. goes_on
      goes_on = cut .and. last%length > 0.0_wp
   end subroutine begin_otherwise

   !> Keep the step from one state to the next
   pure subroutine keep_step(last, length, past, now, multiple)
      type(last_step), intent(inout) :: last
      real(wp), intent(in) :: length
      type(frame_state), intent(in) :: past
      type(frame_state), intent(in) :: now
      real(wp), intent(in) :: multiple                !! its growth
      last%length = length
      last%d = now%d - past%d
      last%slip = now%element%slip - past%element%slip
      last%multiple = multiple
   end subroutine keep_step

   !> Let the moments of failed elements fade at one control displacement; further elements may fail meanwhile
   subroutine redistribute(model, pattern, control, start, moved, past, multiple, path, status)
      type(frame), intent(in) :: model
      real(wp), intent(in) :: pattern(:)
      real(wp), intent(in) :: control(:)
      real(wp), intent(in) :: start
      real(wp), intent(in) :: moved
      type(frame_state), intent(inout) :: past
      real(wp), intent(inout) :: multiple
      type(push_path), intent(inout) :: path
      integer(c_int), intent(out) :: status
      type(frame_state) :: now, from   ! now: once damped, it stays so
      type(last_step) :: last
      real(wp) :: part, trial, kept
      logical :: goes_on, cut
      integer :: failed, e, tries
      call frame_state_new(model, now, failed)
      if (failed == 0) call frame_state_new(model, from, failed)
      status = status_out_of_memory
      if (failed /= 0) return
      part = 0.25_wp
      goes_on = .false.
      do tries = 1, most_parts
         call take_over(past, from)
         do e = 1, size(model%element)
            associate (state => from%element(e))
               if (state%state < frame_state_failed_flexure) cycle
               kept = model%element(e)%kept
               state%left = max(kept, state%left - part * (1.0_wp - kept))
            end associate
         end do
         call take_over(from, now)
         trial = multiple
         if (goes_on) call go_on(last, part, now, trial)
         call equilibrate(model, 1.0_wp, from, pattern, control, start + moved, .true., now, trial, status)
         if (status /= status_ok) then
            call begin_otherwise(last, goes_on, cut)
            if (.not. cut) cycle
            part = 0.5_wp * part
            if (part < 1.0e-3_wp) then
               if (now%damped .and. now%lagged) then
                  path%loose = maxloc(abs(now%d - past%d), 1)
                  return
               end if
               call try_otherwise(now)
               part = merge(0.25_wp, 0.05_wp, now%damped)
            end if
            cycle
         end if
         now%lagged = .false.
         goes_on = .true.
         call keep_step(last, part, past, now, trial - multiple)
         part = min(0.25_wp, 2.0_wp * part)
         multiple = trial
         call commit(model, now, failed)
         call take_over(now, past)
         if (failed == 0 .and. all(past%element%state < frame_state_failed_flexure .or. &
            past%element%left <= model%element%kept)) exit
      end do
      if (tries > most_parts) then   ! moments are left that have not faded
         status = status_too_many_steps
         path%loose = maxloc(abs(now%d - from%d), 1)
      end if
      call note(path, past, moved, multiple)
   end subroutine redistribute

   !> Keep a state of a run
   pure subroutine note(path, state, moved, multiple)
      type(push_path), intent(inout) :: path
      type(frame_state), intent(in) :: state
      real(wp), intent(in) :: moved
      real(wp), intent(in) :: multiple
      integer :: e
      path%count = path%count + 1
      associate (k => path%count)
         path%curve(:, k) = [moved, multiple]
         path%displacement(:, k) = state%d
         do e = 1, size(state%element)
            path%force(:, e, k) = state%element(e)%force
            path%drift(e, k) = maxval(abs(state%element(e)%deformation(2:3)))
            path%state(e, k) = state%element(e)%state
         end do
      end associate
   end subroutine note

   !> Motion of a frame relative to the ground, by Newmark's method of constant acceleration.
   !>
   !> Damping is alpha M + beta K, K the tangent of the last state in equilibrium. A step that does not converge is
   !> halved.
   subroutine move_frame(model, unit, acceleration, time_step, damping, path, shear, ended, status)
      type(frame), intent(in) :: model
      real(wp), intent(in) :: unit(:)                 !! (n) displacements of a unit motion of the ground
      real(wp), intent(in) :: acceleration(:)         !! of the ground at each step [m/s^2]
      real(wp), intent(in) :: time_step               !! [s]
      real(wp), intent(in) :: damping(2)              !! alpha [1/s], beta [s]
      type(push_path), intent(inout) :: path          !! with room for as many states
      real(wp), intent(out) :: shear(:)               !! internal base shear along the motion [N]
      integer(c_int), intent(out) :: ended             !! of the list frame_stop
      integer(c_int), intent(out) :: status
      integer, parameter :: halvings = 8
      type(frame_state) :: past
      real(wp) :: velocity(model%n), accelerated(model%n), from, to
      integer :: k, pieces, piece, failed
      path%count = 0
      shear = 0.0_wp
      ended = frame_stop_weight
      call weigh_frame(model, past, status)
      if (status /= status_ok) then
         if (status /= status_out_of_memory) status = status_ok
         return
      end if
      velocity = 0.0_wp
      accelerated = -acceleration(1) * unit
      call note(path, past, 0.0_wp, 0.0_wp)
      do k = 2, size(acceleration)
         ended = frame_stop_cancelled
         if (extrados_cancel_get() /= 0) return
         pieces = 1
         piece = 0
         do while (piece < pieces)
            from = real(piece, wp) / real(pieces, wp)
            to = real(piece + 1, wp) / real(pieces, wp)
            associate (ground => acceleration(k - 1) + to * (acceleration(k) - acceleration(k - 1)))
               call newmark(model, unit, ground, time_step * (to - from), damping, past, velocity, accelerated, status)
            end associate
            if (status /= status_ok) then
               status = status_ok
               ended = frame_stop_step
               pieces = 2 * pieces
               piece = 2 * piece
               if (pieces > 2**halvings) then
                  if (past%lagged) return
                  past%lagged = .true.
               end if
               cycle
            end if
            piece = piece + 1
            call commit(model, past, failed)
         end do
         past%lagged = .false.
         call fade(model, past, time_step)
         call note(path, past, 0.0_wp, 0.0_wp)
         shear(k) = dot_product(unit, past%force)
      end do
      ended = frame_stop_target
   end subroutine move_frame

   !> Moments of failed elements fade within a twentieth of a second
   pure subroutine fade(model, state, time_step)
      type(frame), intent(in) :: model
      type(frame_state), intent(inout) :: state
      real(wp), intent(in) :: time_step
      integer :: e
      do e = 1, size(model%element)
         if (state%element(e)%state >= frame_state_failed_flexure) state%element(e)%left = &
            max(model%element(e)%kept, state%element(e)%left - time_step / 0.05_wp)
      end do
   end subroutine fade

   !> One step of constant acceleration; everything is left as it was where it does not converge
   subroutine newmark(model, unit, ground, step, damping, past, velocity, accelerated, status)
      type(frame), intent(in) :: model
      real(wp), intent(in) :: unit(:)
      real(wp), intent(in) :: ground
      real(wp), intent(in) :: step
      real(wp), intent(in) :: damping(2)
      type(frame_state), intent(inout) :: past
      real(wp), intent(inout) :: velocity(:)
      real(wp), intent(inout) :: accelerated(:)
      integer(c_int), intent(out) :: status
      type(frame_state) :: now
      real(wp) :: right(model%n, 1), matrix(model%n, model%n), new_velocity(model%n), new_acceleration(model%n), scale
      real(wp) :: load(model%n), inertia(model%n), damped(model%n)
      integer :: iteration, found
      call frame_state_new(model, now, found)
      status = status_out_of_memory
      if (found /= 0) return
      now%lagged = past%lagged
      load = matmul(model%mass, unit)
      load = model%weight - ground * load
      scale = 1.0e-6_wp * sum(abs(model%weight))
      call take_over(past, now)
      found = 1
      do iteration = 1, 20
         call assemble(model, past, now, status)
         if (status /= status_ok) return
         new_velocity = 2.0_wp / step * (now%d - past%d) - velocity
         new_acceleration = 4.0_wp / step**2 * (now%d - past%d) - 4.0_wp / step * velocity - accelerated
         damped = new_acceleration + damping(1) * new_velocity
         inertia = matmul(model%mass, damped)
         damped = matmul(past%tangent, new_velocity)
         right(:, 1) = load - now%force - inertia - damping(2) * damped
         if (.not. maxval(abs(right(:, 1))) <= huge(1.0_wp)) exit
         if (iteration > 1 .and. maxval(abs(right(:, 1))) <= scale) then
            found = status_ok
            exit
         end if
         matrix = now%tangent + (4.0_wp / step**2 + 2.0_wp * damping(1) / step) * model%mass &
            + 2.0_wp * damping(2) / step * past%tangent
         call solve(matrix, right, status)
         if (status /= status_ok) return
         now%d(:) = now%d + right(:, 1)
      end do
      status = found
      if (found /= status_ok) return
      call take_over(now, past)
      velocity = new_velocity
      accelerated = new_acceleration
   end subroutine newmark

end module frame_push
