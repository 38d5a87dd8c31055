!> Frames of macro-elements behind handles, built in steps.
module frame_handle
   use common_handles, only : handle_new, handle_take
   use common_kinds, only : wp
   use common_lists, only : handle_frame, frame_shear_count, frame_shear_diagonal, frame_shear_least, &
      frame_shear_damage, frame_shear_reversed
   use common_status, only : status_ok, status_bad_index, status_invalid_argument, status_not_finite, &
      status_not_ready, status_out_of_memory
   use frame_element, only : macro_element
   use frame_laws, only : masonry_section, shear_law
   use frame_model, only : frame, frame_link
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_funloc, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   implicit none
   private
   public :: frame_new, frame_destroy, frame_take, set_elements, set_links, set_loads, frame_properties

   !> Numbers of an element, in the order of `property` in set_elements
   integer, parameter :: frame_properties = 25

contains

   !> A frame without elements
   subroutine frame_new(n, handle, status)
      integer(c_int), intent(in) :: n            !! freedoms
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      type(frame), pointer :: model
      integer :: failed
      handle = 0
      status = status_invalid_argument
      if (n < 1) return
      status = status_out_of_memory
      allocate (model, stat=failed)
      if (failed /= 0) return
      model%n = n
      allocate (model%element(0), model%link(0), stat=failed)
      if (failed == 0) call handle_new(handle_frame, c_loc(model), c_funloc(frame_destroy), handle, status)
      if (status /= status_ok) deallocate (model)
   end subroutine frame_new

   !> Called by the registry
   subroutine frame_destroy(object) bind(c, name='extrados_frame_destroy')
      type(c_ptr), value, intent(in) :: object
      type(frame), pointer :: model
      call c_f_pointer(object, model)
      deallocate (model)
   end subroutine frame_destroy

   !> The frame of a handle, until handle_leave; null where the status is not ok
   subroutine frame_take(handle, alone, n, whole, model, status)
      integer(c_int64_t), intent(in) :: handle
      logical, intent(in) :: alone               !! this call changes it
      integer(c_int), intent(in) :: n            !! freedoms that the caller's arrays have
      logical, intent(in) :: whole               !! loads must be there
      type(frame), pointer, intent(out) :: model
      integer(c_int), intent(out) :: status
      type(c_ptr) :: object
      model => null()
      object = c_null_ptr
      call handle_take(handle, handle_frame, alone, object, status)
      if (status /= status_ok) return
      call c_f_pointer(object, model)
      if (n /= model%n) status = status_invalid_argument
      if (whole .and. .not. allocated(model%linear)) status = status_not_ready
   end subroutine frame_take

   !> Piers and beams in place of those before
   subroutine set_elements(model, choice, freedom, property, status)
      type(frame), intent(inout) :: model
      !> (6, elements) 1: pier (else a beam); 1: its axis is vertical; list frame_shear; sections, 3 or 5; 1: P-Delta;
      !> 1: the shear strength makes the hinge's
      integer(c_int), intent(in) :: choice(:, :)
      integer(c_int), intent(in) :: freedom(:, :)   !! (6, elements) u, w, rotation of both nodes, 1-based; 0 is held
      !> (25, elements) offsets along the wall and upward of both ends; deformable length; of the section length,
      !> thickness, modulus, strength, residual share; shear stiffness, cohesion, friction, diagonal strength,
      !> slenderness, compliance, softening, slip at the peak; drift limits in flexure and shear, kept share;
      !> beam: E I, E A, moment; pier: own weight
      real(wp), intent(in) :: property(:, :)
      integer(c_int), intent(out) :: status
      type(macro_element), allocatable :: element(:)
      integer :: e, failed
      status = status_bad_index
      if (any(freedom < 0) .or. any(freedom > model%n)) return
      status = status_not_finite
      if (.not. all(abs(property) <= huge(1.0_wp))) return
      status = status_invalid_argument
      if (size(property, 1) /= frame_properties .or. any(choice(3, :) < 0) .or. &
         any(choice(3, :) >= frame_shear_count) .or. .not. all(choice(4, :) == 3 .or. choice(4, :) == 5)) return
      if (any(property(5:9, :) <= 0.0_wp) .or. any(property(11, :) < 0.0_wp)) return
      if (any(choice(1, :) == 0 .and. (property(11, :) <= 0.0_wp .or. property(22, :) <= 0.0_wp))) return
      if (any((choice(3, :) == frame_shear_diagonal .or. choice(3, :) == frame_shear_least .or. &
         choice(3, :) == frame_shear_reversed) .and. &
         (property(14, :) <= 0.0_wp .or. property(15, :) <= 0.0_wp))) return
      if (any(choice(3, :) == frame_shear_damage .and. (property(16, :) <= 0.0_wp .or. property(17, :) >= 2.0_wp .or. &
         property(18, :) <= 0.0_wp))) return
      allocate (element(size(property, 2)), stat=failed)
      status = status_out_of_memory
      if (failed /= 0) return
      do e = 1, size(element)
         associate (p => property(:, e))
            element(e)%pier = choice(1, e) /= 0
            element(e)%upright = choice(2, e) /= 0
            element(e)%sections = choice(4, e)
            element(e)%second_order = choice(5, e) /= 0
            element(e)%hinge_by_shear = choice(6, e) /= 0
            element(e)%freedom = freedom(:, e)
            element(e)%offset = reshape(p(1:4), [2, 2])
            element(e)%length = p(5)
            element(e)%section = masonry_section(p(6), p(7), p(8), p(9), p(10))
            element(e)%shear_stiffness = p(11)
            element(e)%shear = shear_law(choice(3, e), p(6), p(7), p(12), p(13), p(14), p(15), p(16), p(17), p(18))
            element(e)%drift = p(19:20)
            element(e)%kept = p(21)
            element(e)%inertia_stiffness = p(22)
            element(e)%axial_stiffness = p(23)
            element(e)%moment = p(24)
            element(e)%own_weight = p(25)
         end associate
      end do
      call move_alloc(element, model%element)
      status = status_ok
   end subroutine set_elements

   !> Links in place of those before
   subroutine set_links(model, freedom, part, property, status)
      type(frame), intent(inout) :: model
      integer(c_int), intent(in) :: freedom(:, :)   !! (8, links) 1-based; 0 is held
      real(wp), intent(in) :: part(:, :)            !! (8, links) of each displacement in the deformation
      real(wp), intent(in) :: property(:, :)        !! (5, links) stiffness, strengths against - and +, prestress, 1: returns
      integer(c_int), intent(out) :: status
      type(frame_link), allocatable :: link(:)
      integer :: k, failed
      status = status_bad_index
      if (any(freedom < 0) .or. any(freedom > model%n)) return
      status = status_not_finite
      if (.not. all(abs(property) <= huge(1.0_wp)) .or. .not. all(abs(part) <= huge(1.0_wp))) return
      status = status_invalid_argument
      if (any(property(1, :) <= 0.0_wp) .or. any(property(2:3, :) < 0.0_wp)) return
      allocate (link(size(property, 2)), stat=failed)
      status = status_out_of_memory
      if (failed /= 0) return
      call move_alloc(link, model%link)
      do k = 1, size(model%link)
         model%link(k)%freedom = freedom(:, k)
         model%link(k)%part = part(:, k)
         model%link(k)%stiffness = property(1, k)
         model%link(k)%strength = property(2:3, k)
         model%link(k)%force = property(4, k)
         model%link(k)%returns = property(5, k) > 0.5_wp
      end do
      status = status_ok
   end subroutine set_links

   !> What stays elastic, the constant loads and the masses
   subroutine set_loads(model, linear, weight, mass, status)
      type(frame), intent(inout) :: model
      real(wp), intent(in) :: linear(:, :)          !! (n, n) [N/m]
      real(wp), intent(in) :: weight(:)             !! (n) [N]
      real(wp), intent(in) :: mass(:, :)            !! (n, n) [kg]
      integer(c_int), intent(out) :: status
      integer :: failed
      status = status_not_finite
      if (.not. all(abs(linear) <= huge(1.0_wp)) .or. .not. all(abs(weight) <= huge(1.0_wp)) .or. &
         .not. all(abs(mass) <= huge(1.0_wp))) return
      if (.not. allocated(model%linear)) then
         allocate (model%linear(model%n, model%n), model%weight(model%n), model%mass(model%n, model%n), stat=failed)
         status = status_out_of_memory
         if (failed /= 0) return
      end if
      model%linear(:, :) = linear
      model%weight(:) = weight
      model%mass(:, :) = mass
      status = status_ok
   end subroutine set_loads

end module frame_handle
