!> Frames of macro-elements. Freedoms are 1-based; 0 is held.
module api_frame
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: new_frame, elements, links, loads, at_rest, push, move, section

contains

   !> A frame without elements
   subroutine new_frame(n, handle, status)
      use frame_handle, only : frame_new
      integer(c_int), intent(in) :: n                  !! freedoms
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      call frame_new(n, handle, status)
   end subroutine new_frame

   !> Piers and beams, see set_elements
   subroutine elements(handle, n, count, choice, freedom, property, status)
      use common_handles, only : handle_leave
      use frame_handle, only : frame_take, set_elements
      use frame_model, only : frame
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n
      integer(c_int), intent(in) :: count
      integer(c_int), intent(in) :: choice(6, count)
      integer(c_int), intent(in) :: freedom(6, count)
      real(c_double), intent(in) :: property(25, count)
      integer(c_int), intent(out) :: status
      type(frame), pointer :: model
      call frame_take(handle, .true., n, .false., model, status)
      if (.not. associated(model)) return
      if (status == 0) call set_elements(model, choice, freedom, property, status)
      call handle_leave(handle)
   end subroutine elements

   !> Elastic, perfectly plastic links, see set_links
   subroutine links(handle, n, count, freedom, part, property, status)
      use common_handles, only : handle_leave
      use frame_handle, only : frame_take, set_links
      use frame_model, only : frame
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n
      integer(c_int), intent(in) :: count
      integer(c_int), intent(in) :: freedom(8, count)
      real(c_double), intent(in) :: part(8, count)
      real(c_double), intent(in) :: property(5, count)
      integer(c_int), intent(out) :: status
      type(frame), pointer :: model
      call frame_take(handle, .true., n, .false., model, status)
      if (.not. associated(model)) return
      if (status == 0) call set_links(model, freedom, part, property, status)
      call handle_leave(handle)
   end subroutine links

   !> What stays elastic, the constant loads, the masses
   subroutine loads(handle, n, linear, weight, mass, status)
      use common_handles, only : handle_leave
      use frame_handle, only : frame_take, set_loads
      use frame_model, only : frame
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: linear(n, n)       !! [N/m]
      real(c_double), intent(in) :: weight(n)          !! [N]
      real(c_double), intent(in) :: mass(n, n)         !! [kg]
      integer(c_int), intent(out) :: status
      type(frame), pointer :: model
      call frame_take(handle, .true., n, .false., model, status)
      if (.not. associated(model)) return
      if (status == 0) call set_loads(model, linear, weight, mass, status)
      call handle_leave(handle)
   end subroutine loads

   !> Equilibrium under the constant loads, and the tangent there
   subroutine at_rest(handle, n, count, displacement, force, tangent, status)
      use common_handles, only : handle_leave
      use common_status, only : status_invalid_argument
      use frame_handle, only : frame_take
      use frame_model, only : frame, frame_state
      use frame_push, only : weigh_frame
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n
      integer(c_int), intent(in) :: count              !! elements
      real(c_double), intent(out) :: displacement(n)   !! [m]
      real(c_double), intent(out) :: force(3, count)   !! N [N], moments at both ends [N m]
      real(c_double), intent(out) :: tangent(n, n)
      integer(c_int), intent(out) :: status
      type(frame), pointer :: model
      type(frame_state) :: state
      integer :: e
      !f2py threadsafe
      displacement = 0.0_c_double
      force = 0.0_c_double
      tangent = 0.0_c_double
      call frame_take(handle, .false., n, .true., model, status)
      if (.not. associated(model)) return
      if (status == 0 .and. count /= size(model%element)) status = status_invalid_argument
      if (status == 0) call weigh_frame(model, state, status)
      if (status == 0) then
         displacement(:) = state%d
         tangent(:, :) = state%tangent
         do e = 1, count
            force(:, e) = state%element(e)%force
         end do
      end if
      call handle_leave(handle)
   end subroutine at_rest

   !> Push by a growing multiple of a pattern, see push_frame
   subroutine push(handle, n, count, most, pattern, control, target, steps, drop, states, ended, curve, displacement, force, &
      drift, state, status)
      use common_handles, only : handle_leave
      use common_status, only : status_invalid_argument
      use frame_handle, only : frame_take
      use frame_model, only : frame
      use frame_push, only : push_frame, push_path, push_path_new
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n
      integer(c_int), intent(in) :: count                    !! elements
      integer(c_int), intent(in) :: most                     !! states that there is room for
      real(c_double), intent(in) :: pattern(n)               !! [N]
      real(c_double), intent(in) :: control(n)
      real(c_double), intent(in) :: target                   !! control displacement at the end [m]
      integer(c_int), intent(in) :: steps
      real(c_double), intent(in) :: drop                     !! share of the greatest multiple at which it ends
      integer(c_int), intent(out) :: states
      !> List frame_stop; freedom from 1 that moves most without equilibrium, else 0
      integer(c_int), intent(out) :: ended(2)
      real(c_double), intent(out) :: curve(2, most)          !! control displacement, multiple
      real(c_double), intent(out) :: displacement(n, most)
      real(c_double), intent(out) :: force(3, count, most)   !! N, moments at both ends
      real(c_double), intent(out) :: drift(count, most)
      integer(c_int), intent(out) :: state(count, most)      !! list frame_state
      integer(c_int), intent(out) :: status
      type(frame), pointer :: model
      type(push_path) :: path
      !f2py threadsafe
      states = 0
      ended = 0
      curve = 0.0_c_double
      displacement = 0.0_c_double
      force = 0.0_c_double
      drift = 0.0_c_double
      state = 0
      call frame_take(handle, .false., n, .true., model, status)
      if (.not. associated(model)) return
      if (count /= size(model%element) .or. steps < 1 .or. .not. target > 0.0_c_double) then
         if (status == 0) status = status_invalid_argument
      else if (status == 0) then
         call push_path_new(n, count, most, path, status)
         if (status == 0) call push_frame(model, pattern, control, target, int(steps), drop, &
            path, ended(1), status)
      end if
      if (status == 0) then
         states = path%count
         ended(2) = path%loose
         curve(:, :) = path%curve
         displacement(:, :) = path%displacement
         force(:, :, :) = path%force
         drift(:, :) = path%drift
         state(:, :) = path%state
      end if
      call handle_leave(handle)
   end subroutine push

   !> Motion relative to the ground, see move_frame
   subroutine move(handle, n, count, most, unit, acceleration, time_step, damping, states, ended, displacement, shear, &
      force, drift, state, status)
      use common_handles, only : handle_leave
      use common_status, only : status_invalid_argument
      use frame_handle, only : frame_take
      use frame_model, only : frame
      use frame_push, only : move_frame, push_path, push_path_new
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n
      integer(c_int), intent(in) :: count                    !! elements
      integer(c_int), intent(in) :: most                     !! samples of the acceleration
      real(c_double), intent(in) :: unit(n)                  !! displacements of a unit motion of the ground
      real(c_double), intent(in) :: acceleration(most)       !! of the ground [m/s^2]
      real(c_double), intent(in) :: time_step                !! [s]
      real(c_double), intent(in) :: damping(2)               !! of the mass [1/s], of the stiffness [s]
      integer(c_int), intent(out) :: states
      integer(c_int), intent(out) :: ended                    !! list frame_stop
      real(c_double), intent(out) :: displacement(n, most)   !! [m]
      real(c_double), intent(out) :: shear(most)             !! internal base shear [N]
      real(c_double), intent(out) :: force(3, count, most)   !! N, moments at both ends
      real(c_double), intent(out) :: drift(count, most)
      integer(c_int), intent(out) :: state(count, most)      !! list frame_state
      integer(c_int), intent(out) :: status
      type(frame), pointer :: model
      type(push_path) :: path
      !f2py threadsafe
      states = 0
      ended = 0
      displacement = 0.0_c_double
      shear = 0.0_c_double
      force = 0.0_c_double
      drift = 0.0_c_double
      state = 0
      call frame_take(handle, .false., n, .true., model, status)
      if (.not. associated(model)) return
      if (count /= size(model%element) .or. .not. time_step > 0.0_c_double) then
         if (status == 0) status = status_invalid_argument
      else if (status == 0) then
         call push_path_new(n, count, most, path, status)
         if (status == 0) call move_frame(model, unit, acceleration, time_step, damping, path, shear, ended, status)
      end if
      if (status == 0) then
         states = path%count
         displacement(:, :) = path%displacement
         force(:, :, :) = path%force
         drift(:, :) = path%drift
         state(:, :) = path%state
      end if
      call handle_leave(handle)
   end subroutine move

   !> Normal force and moment of a section of masonry, its tangent, and the crushing after
   subroutine section(property, strain, past, force, tangent, after)
      use frame_laws, only : crushed_further, crushing, masonry_section, section_forces
      real(c_double), intent(in) :: property(5)    !! length, thickness, modulus, strength, residual share
      real(c_double), intent(in) :: strain(2)      !! at the middle, curvature
      real(c_double), intent(in) :: past(4)        !! ductility of both edges, crushed share of both
      real(c_double), intent(out) :: force(2)
      real(c_double), intent(out) :: tangent(2, 2)
      real(c_double), intent(out) :: after(4)
      type(masonry_section) :: of
      type(crushing) :: then
      of = masonry_section(property(1), property(2), property(3), property(4), property(5))
      call section_forces(of, strain, crushing(past(1:2), past(3:4)), force, tangent)
      then = crushed_further(of, strain, crushing(past(1:2), past(3:4)))
      after = [then%ductility, then%share]
   end subroutine section

end module api_frame
