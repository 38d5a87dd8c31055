!> Sequentially linear analysis: joints of no thickness for a model of api_sla_model.
!>
!> Nodes and elements are 1-based.
module api_sla_joints
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: joints

contains

   !> Joints of no thickness; their tooth tables measure openings (band 1)
   subroutine joints(handle, elements, connect, property, choice, ripple, bad, status)
      use common_status, only : status_ok, status_bad_index, status_invalid_argument, status_out_of_memory
      use sla_group, only : element_group
      use sla_handle, only : group_added, group_begun
      use sla_interface, only : interface_group, interface_group_new, joint_law, joint_law_new
      use sla_model, only : element_model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: connect(4, elements)      !! along the lower, back along the upper side
      !> Areas of the two points [m^2] (0: it stands in the neighbour), normal stiffness, shear stiffness [Pa/m],
      !> friction (negative: no sliding), stress that counts as small [Pa], cosine and sine of the normal
      real(c_double), intent(in) :: property(8, elements)
      !> Tables of tension, compression and cohesion teeth, 0 none; 1: no tensile strength
      integer(c_int), intent(in) :: choice(4, elements)
      real(c_double), intent(in) :: ripple                    !! half-width of the steps of friction over the friction
      integer(c_int), intent(out) :: bad                      !! element without area or normal
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      type(interface_group), allocatable :: new_joints
      class(element_group), allocatable :: group
      type(joint_law) :: strength
      integer :: info
      !f2py threadsafe
      bad = 0
      call group_begun(handle, connect, choice(1:3, :), model, status)
      if (status /= status_ok) return
      allocate (new_joints, stat=info)
      if (any(choice(4, :) < 0)) then
         status = status_bad_index
      else if (.not. (all(property(3:4, :) > 0.0_c_double) .and. all(property(6, :) > 0.0_c_double) .and. &
                      ripple > 0.0_c_double .and. ripple < 0.25_c_double)) then
         status = status_invalid_argument
      else if (info /= 0) then
         status = status_out_of_memory
      else
         call joint_law_new(int(elements), strength, status)
      end if
      if (status == status_ok) then
         strength%kn(:) = property(3, :)
         strength%ks(:) = property(4, :)
         strength%friction(:) = property(5, :)
         strength%small(:) = property(6, :)
         strength%table(:) = choice(1, :)
         strength%crush_table(:) = choice(2, :)
         strength%slip_table(:) = choice(3, :)
         strength%dry(:) = choice(4, :)
         strength%ripple = ripple
         call interface_group_new(property(1:2, :), property(7:8, :), strength, model%teeth, model%options, &
            new_joints, bad, status)
      end if
      call move_alloc(new_joints, group)
      call group_added(handle, model, connect, 2, group, status)
   end subroutine joints

end module api_sla_joints
