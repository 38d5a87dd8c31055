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
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_new
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
      !f2py threadsafe
      bad = 0
      call model_take(handle, stage_new, stage_new, model, status)
      if (status /= status_ok) return
      call add(status)
      call handle_leave(handle)

   contains

      subroutine add(fate)
         use common_status, only : status_bad_index, status_invalid_argument, status_out_of_memory
         use sla_group, only : element_group
         use sla_handle, only : both_directions, check_nodes
         use sla_interface, only : interface_group, interface_group_new, joint_law, joint_law_new
         use sla_model, only : model_add
         integer(c_int), intent(out) :: fate
         type(interface_group), allocatable :: new_joints
         class(element_group), allocatable :: group
         type(joint_law) :: strength
         integer(c_int), allocatable :: node(:, :), direction(:, :)
         integer :: info
         call check_nodes(model, connect, 1_c_int, fate)
         if (fate /= status_ok) return
         fate = status_bad_index
         if (any(choice < 0) .or. any(choice(1:3, :) > model%teeth%tables())) return
         fate = status_invalid_argument
         if (.not. (all(property(3:4, :) > 0.0_c_double) .and. all(property(6, :) > 0.0_c_double))) return
         if (.not. (ripple > 0.0_c_double .and. ripple < 0.25_c_double)) return
         fate = status_out_of_memory
         allocate (new_joints, stat=info)
         if (info /= 0) return
         call joint_law_new(int(elements), strength, fate)
         if (fate /= status_ok) return
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
            new_joints, bad, fate)
         if (fate /= status_ok) return
         call move_alloc(new_joints, group)
         call both_directions(connect, node, direction, fate)
         if (fate /= status_ok) return
         call model_add(model, group, node, direction, fate)
      end subroutine add

   end subroutine joints

end module api_sla_joints
